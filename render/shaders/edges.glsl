// Smooths the edges of a picture with one sample per pixel. FIND only finds edges, and marks their
// pixels in the depth buffer; so the smoothing pass skips all other pixels on software OpenGL.
//
// Source: Timothy Lottes, "FXAA" (NVIDIA, 2009), the short version. Where lightness changes, pixels
// along the edge are averaged. A wide mean that leaves the range of the neighbours is replaced by a
// narrow one.

#if defined(VERTEX_STAGE)

void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

uniform sampler2D scene;
out vec4 pixel_colour;

const vec3 LIGHTNESS = vec3(0.299, 0.587, 0.114);  // weights of sRGB
// Smallest change that counts as an edge, absolute and relative; details of skin change less.
const float LEAST = 0.06, LEAST_SHARE = 0.16;
const float REACH = 2.5;  // [pixels] along an edge; more would make pupils square

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), end = textureSize(scene, 0) - 1;
    ivec2 low = max(at - 1, 0), high = min(at + 1, end);
    float here = dot(texelFetch(scene, at, 0).rgb, LIGHTNESS);
    float nw = dot(texelFetch(scene, ivec2(low.x, high.y), 0).rgb, LIGHTNESS);
    float ne = dot(texelFetch(scene, high, 0).rgb, LIGHTNESS);
    float sw = dot(texelFetch(scene, low, 0).rgb, LIGHTNESS);
    float se = dot(texelFetch(scene, ivec2(high.x, low.y), 0).rgb, LIGHTNESS);
    float least = min(here, min(min(nw, ne), min(sw, se)));
    float most = max(here, max(max(nw, ne), max(sw, se)));
#if defined(FIND)
    if (most - least < max(LEAST, LEAST_SHARE * most)) discard;
    pixel_colour = vec4(0.0);
#else
    vec2 pixel = 1.0 / vec2(end + 1), place = gl_FragCoord.xy * pixel;
    vec2 along = vec2(sw + se - nw - ne, nw + sw - ne - se);
    float damping = max(0.03 * (nw + ne + sw + se), 0.008);
    along = clamp(along / (min(abs(along.x), abs(along.y)) + damping), -REACH, REACH) * pixel;
    vec4 near = 0.5 * (textureLod(scene, place - along / 6.0, 0.0)
                       + textureLod(scene, place + along / 6.0, 0.0));
    vec4 far = 0.5 * near + 0.25 * (textureLod(scene, place - along / 2.0, 0.0)
                                    + textureLod(scene, place + along / 2.0, 0.0));
    float reached = dot(far.rgb, LIGHTNESS);
    pixel_colour = reached < least || reached > most ? near : far;
#endif
}

#endif
