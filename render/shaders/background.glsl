// The background of a viewport, at the far end of depth: a soft gradient, or with MAP a map of
// light from all around.

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
uniform sampler2D radiance;  // linear light, its first row above; see light_map.py
uniform vec2 half_size;      // of the viewport at distance 1 from the eye
uniform float turn;          // of the map to the right [radians]

// The radiance at a place of the map, 0..1 each way: a cubic B-spline of its texels, for straight
// lines between a few hundred texels show as a grid. Four blended reads make the sixteen of it.
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
    // Half a grey level of interleaved gradient noise (Jimenez 2014) hides the steps of 8 bits.
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    pixel_colour = vec4(background() + (noise - 0.5) / 255.0, 1.0);
}

#endif
