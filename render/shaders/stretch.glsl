// A picture over the whole viewport: a label, a scene of fewer pixels, which is enlarged, or one that
// has a single sample in each pixel (SMOOTH): its edges become smooth.
//
// Source: Timothy Lottes, "FXAA" (NVIDIA, 2009), the short version: where light changes, pixels
// along the edge are averaged, unless that reaches beyond it.

#if defined(VERTEX_STAGE)

out vec2 place;  // 0..1

void main() {
    place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

in vec2 place;
uniform sampler2D scene;
out vec4 pixel_colour;

#if defined(SMOOTH)
const vec3 LIGHTNESS = vec3(0.299, 0.587, 0.114);  // of sRGB
const float LEAST = 0.06, LEAST_SHARE = 0.16;  // of a change that is an edge: features of skin are less
const float REACH = 2.5;  // pixels along an edge; farther, and pupils become squares

float light_at(vec2 offset) {
    return dot(textureLod(scene, place + offset, 0.0).rgb, LIGHTNESS);
}

vec4 smoothed(vec4 middle) {
    vec2 pixel = 1.0 / vec2(textureSize(scene, 0));
    float here = dot(middle.rgb, LIGHTNESS);
    float nw = light_at(vec2(-pixel.x, pixel.y)), ne = light_at(pixel);
    float sw = light_at(-pixel), se = light_at(vec2(pixel.x, -pixel.y));
    float least = min(here, min(min(nw, ne), min(sw, se)));
    float most = max(here, max(max(nw, ne), max(sw, se)));
    if (most - least < max(LEAST, LEAST_SHARE * most)) return middle;
    vec2 along = vec2(sw + se - nw - ne, nw + sw - ne - se);
    float damping = max(0.03 * (nw + ne + sw + se), 0.008);
    along = clamp(along / (min(abs(along.x), abs(along.y)) + damping), -REACH, REACH) * pixel;
    vec4 near = 0.5 * (textureLod(scene, place - along / 6.0, 0.0)
                       + textureLod(scene, place + along / 6.0, 0.0));
    vec4 far = 0.5 * near + 0.25 * (textureLod(scene, place - along / 2.0, 0.0)
                                    + textureLod(scene, place + along / 2.0, 0.0));
    float reached = dot(far.rgb, LIGHTNESS);
    return reached < least || reached > most ? near : far;
}
#endif

void main() {
    pixel_colour = textureLod(scene, place, 0.0);
#if defined(SMOOTH)
    pixel_colour = smoothed(pixel_colour);
#endif
}

#endif
