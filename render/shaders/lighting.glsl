// Light of a portrait, fixed to the camera: a key light, a weak fill light, a rim light from behind
// the head at the right, and ambient light; see `Light` in style.py.
// All vectors are in view space (x right, y up, z to the viewer); all light is linear.

uniform vec3 to_key;  // unit vector toward the key light, from which shadow.py looks
uniform vec3 to_fill;
uniform vec3 key_light;
uniform vec3 fill_light;
uniform vec3 rim_light;
#if defined(AROUND)
uniform vec3 around[9];  // coefficients of ambient light, see light_map.py
#else
uniform vec3 sky;
uniform vec3 ground;
#endif
const vec3 TO_RIM = vec3(0.6200, 0.3600, -0.6972);
// How far each colour scatters in skin past the terminator: red far, blue hardly.
const vec3 SCATTER = vec3(0.19, 0.13, 0.098);
const vec3 BLEED = vec3(0.30, 0.10, 0.04);  // scattering into the edge of a cast shadow
const vec3 BOUNCE = vec3(0.20, 0.105, 0.075);  // key light that lit skin reflects into shadows
const vec3 OCCLUDED_BOUNCE = vec3(0.55, 0.15, 0.05);  // part of occluded light that skin reflects
const float OCCLUDED_KEY = 0.35;  // how much occlusion reduces the key light, which is an area light
const float SHEEN = 0.7;  // strength of the narrow specular lobe of skin
const vec3 WARMTH = vec3(1.25, 0.955, 0.82);  // tint of ambient light by skin nearby

struct Lit {
    vec3 key;       // direct key light; multiply by albedo and lightness
    vec3 rest;      // scattered key light and all other light; multiply by albedo
    vec3 specular;  // specular light; multiply by lightness, and add
};

// Ambient light on a surface.
vec3 hemisphere(vec3 normal) {
#if defined(AROUND)
    float x = normal.x, y = normal.y, z = normal.z;
    vec3 light = around[0] + around[1] * y + around[2] * z + around[3] * x + around[4] * (x * y)
        + around[5] * (y * z) + around[6] * (x * z) + around[7] * (3.0 * z * z - 1.0)
        + around[8] * (x * x - y * y);
    return max(light, 0.0);
#else
    return mix(ground, sky, 0.5 * normal.y + 0.5);
#endif
}

// `openness`: fraction of the rim light that arrives. The rim light throws no shadows, but hardly
// reaches folds, so occlusion must reduce it there. `subsurface`: strength of scattering, above 0.
// `oil`: strength of the narrow lobe, 0 to 1.
Lit studio(
    vec3 normal, vec3 to_eye, float openness, float subsurface, float gloss, float sharpness, float oil
) {
    vec3 scatter = SCATTER * subsurface;
    float rim = max(dot(normal, TO_RIM), 0.0) * openness;
    float grazing = 1.0 - clamp(dot(normal, to_eye), 0.0, 1.0);
    float fresnel = grazing * grazing * grazing;
    vec3 ambient = hemisphere(normal);
    // exp2(-sharpness (1 - cosine)) replaces a power of the cosine, which would also need log2. Skin
    // has a wide lobe, and its oil a narrow lobe (d'Eon, Luebke 2007, GPU Gems 3, chapter 14).
    float highlight = exp2(sharpness * (dot(normal, normalize(to_key + to_eye)) - 1.0));
    float narrow = highlight * highlight;
    highlight *= mix(1.0, 0.8 + SHEEN * oil * narrow, subsurface);
    Lit lit;
    // Key light that scatters past the terminator is not shadowed, and direct key light fades toward
    // the terminator. So the errors of the shadow map, which are largest there, are invisible.
    float facing = dot(normal, to_key);
    lit.key = key_light / (1.0 + scatter) * max(facing, 0.0);
    // Scattered light ends with a slope of 0, else its end would show as a contour.
    vec3 past = max(2.0 * scatter + min(facing, 0.0), 0.0);
    lit.rest = key_light * past * past / (4.0 * scatter * (1.0 + scatter))
        + fill_light * max(0.8 * dot(normal, to_fill) + 0.2, 0.0)
        + rim_light * rim * rim + ambient * mix(vec3(1.0), WARMTH, subsurface);
#if defined(AROUND)
    vec3 mirrored = hemisphere(reflect(-to_eye, normal));
#else
    vec3 mirrored = ambient;
#endif
    lit.specular = gloss * (key_light * highlight + (0.9 * mirrored + rim_light * rim) * fresnel);
    return lit;
}

// `lightness`: 1 in the key light, 0 in its full shadow. `ambient_occlusion`: 1 where all ambient light
// arrives, 0 where none arrives.
vec3 lit_colour(Lit lit, vec3 albedo, float lightness, float subsurface, float ambient_occlusion) {
    // Skin nearby occludes light, and reflects a part of it, which is redder.
    vec3 open = ambient_occlusion * (vec3(1.0) + (1.0 - ambient_occlusion) * subsurface * OCCLUDED_BOUNCE);
    vec3 glow = subsurface * (1.0 - lightness) * (lightness * BLEED + BOUNCE * open);
    return albedo * (lit.key * (lightness * mix(1.0, ambient_occlusion, OCCLUDED_KEY) + glow) + lit.rest * open)
        + lit.specular * (0.25 + 0.75 * lightness) * ambient_occlusion;
}

// Light on the inner side of the skin: ambient light, and a reflection of the key light.
vec3 inside(vec3 normal) {
    return 0.8 * hemisphere(normal) + 0.22 * max(dot(normal, to_key), 0.0);
}

#include "display.glsl"
