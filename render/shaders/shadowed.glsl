// How much of the key light gets to a place, by the map of shadow.py.

uniform sampler2DShadow shadow_map;

// 1 where the key light reaches, 0 in its shadow; place: in the shadow map.
float key_lightness(vec3 place) {
    // The mean of 3 x 3 bilinear tests, by four: each stands between two of them, where the test's
    // own blend weighs them (after I. Castaño's "Shadow mapping summary", 2013).
    float size = float(textureSize(shadow_map, 0).x), texel = 1.0 / size;
    vec2 corner = floor(place.xy * size + 0.5);
    vec2 part = place.xy * size + 0.5 - corner;
    corner -= 0.5;
    vec2 low_weight = 3.0 - 2.0 * part, high_weight = 1.0 + 2.0 * part;
    vec2 low = (corner + (2.0 - part) / low_weight - 1.0) * texel;
    vec2 high = (corner + part / high_weight + 1.0) * texel;
    float lower = low_weight.x * texture(shadow_map, vec3(low, place.z))
        + high_weight.x * texture(shadow_map, vec3(high.x, low.y, place.z));
    float upper = low_weight.x * texture(shadow_map, vec3(low.x, high.y, place.z))
        + high_weight.x * texture(shadow_map, vec3(high, place.z));
    return (low_weight.y * lower + high_weight.y * upper) / 16.0;
}

#if defined(LIFTED)
// A place further above its triangle, if that is steeper toward the light than its normals say: few
// triangles that are shaded as a round surface would else be shadowed in stripes.
// place: in the shadow map; lift: how far it stands above the surface already, along the normal.
vec3 above_triangle(vec3 place, vec3 lift) {
    const float REACH = 2.0;  // of the look-up, to each side [texels]
    vec3 surface = place - lift;
    vec3 across = normalize(cross(dFdx(surface), dFdy(surface)));
    across = dot(across, lift) < 0.0 ? -across : across;
    float rise = REACH / float(textureSize(shadow_map, 0).x) * length(across.xy);
    return place + max(rise - dot(across, lift), 0.0) * across;
}
#endif
