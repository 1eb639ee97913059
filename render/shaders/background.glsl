// The background of a viewport, at the greatest depth: a soft gradient, or with MAP an environment map.

#if defined(VERTEX_STAGE)

out vec2 place;  // -1..1 over the viewport

void main() {
    place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    gl_Position = vec4(place, 1.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

in vec2 place;
out vec4 pixel_colour;

#if defined(MAP)

#include "display.glsl"

const float PI = 3.14159265;
uniform sampler2D radiance;  // linear light, the zenith in the first row; see light_map.py
uniform vec2 half_size;      // half width and height of the viewport at distance 1 from the camera
uniform float turn;          // rotation of the map to the right [radians]

// The radiance at texture coordinates 0..1, by a cubic B-spline of the texels. Linear interpolation of
// a few hundred texels would show as a grid. Four blended reads replace sixteen.
vec3 smooth_radiance(vec2 at) {
    vec2 size = vec2(textureSize(radiance, 0));
    vec2 texel = at * size - 0.5;
    vec2 part = fract(texel);
    vec2 rest = 1.0 - part;
    vec2 first = rest * rest * rest / 6.0;
    vec2 last = part * part * part / 6.0;
    vec2 second = 2.0 / 3.0 - part * part * (1.0 - 0.5 * part);
    vec2 third = 1.0 - first - second - last;
    vec2 share = third + last;
    vec2 before = (floor(texel) - 0.5 + second / (first + second)) / size;
    vec2 after = (floor(texel) + 1.5 + last / share) / size;
    vec3 below = mix(texture(radiance, before), texture(radiance, vec2(after.x, before.y)), share.x).rgb;
    vec3 above = mix(texture(radiance, vec2(before.x, after.y)), texture(radiance, after), share.x).rgb;
    return mix(below, above, share.y);
}

vec3 background() {
    vec2 away = place * half_size;
    float azimuth = atan(away.x) - turn;
    float elevation = atan(away.y / length(vec2(1.0, away.x)));
    return display(smooth_radiance(vec2(azimuth / (2.0 * PI) + 0.5, 0.5 - elevation / PI)));
}

#else

uniform vec3 centre;
uniform vec3 edge;

vec3 background() {
    vec2 away = place - vec2(-0.08, 0.16);
    float distance = dot(away, away) * 0.44;
    return mix(centre, edge, distance / (0.35 + distance) * 1.35);
}

#endif

void main() {
    // Interleaved gradient noise (Jimenez 2014) of half a grey level hides the steps of 8 bits.
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    pixel_colour = vec4(background() + (noise - 0.5) / 255.0, 1.0);
}

#endif
