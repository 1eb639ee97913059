// Look-ups in the shadow map of shadow.py.

uniform sampler2DShadow shadow_map;

// 1 in the key light, 0 in its shadow; place: point in the space of the shadow map.
float key_lightness(vec3 place) {
    // The mean of 3 x 3 bilinear depth tests, by four look-ups between them, where bilinear filtering
    // gives the right weights (after I. Castaño's "Shadow mapping summary", 2013).
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
// Moves a point farther above its triangle if the triangle is steeper to the light than its normals
// say. Otherwise large triangles that are shaded as a round surface would have stripes of shadow.
// place: point in the space of the shadow map, already moved by `lift` along the normal.
vec3 above_triangle(vec3 place, vec3 lift) {
    const float REACH = 2.0;  // [texels] radius of the look-up
    vec3 surface = place - lift;
    vec3 across = normalize(cross(dFdx(surface), dFdy(surface)));
    across = dot(across, lift) < 0.0 ? -across : across;
    float rise = REACH / float(textureSize(shadow_map, 0).x) * length(across.xy);
    return place + max(rise - dot(across, lift), 0.0) * across;
}
#endif
