// A triangle with a point in the middle: its row, by the geomorph weights of the edges, and its
// weights of the corners (refine/beyond/blending.py, surface_normals.py).
vec2 rule_weights(float own, float other, float third) {
    float rival = max(other, third);
    precise float alone = own - rival, pair = min(own, rival) - min(own, min(other, third));
    return vec2(max(alone, 0.0), pair);
}

float value_of(uint row, uint column) { return rows[columns * row + column]; }

FOR_EACH(t, face_count) {
    if (!has_centre(configurations(t))) return;
    uint row = first_centre(t), v[3], w[3], e[3];
    float geomorph[3];
    for (uint i = 0u; i < 3u; ++i) {
        v[i] = faces(3u * t + i);
        w[i] = corners(3u * t + i);
        e[i] = triangle_edges(3u * t + i);
        geomorph[i] = splits(e[i]) > 0u ? edge_normals(e[i]).w : 0.0;
    }
    float least = min(geomorph[0], min(geomorph[1], geomorph[2]));
    float most = max(geomorph[0], max(geomorph[1], geomorph[2]));
    vec2 x = rule_weights(geomorph[0], geomorph[1], geomorph[2]);
    vec2 y = rule_weights(geomorph[1], geomorph[2], geomorph[0]);
    vec2 z = rule_weights(geomorph[2], geomorph[0], geomorph[1]);
    precise float none = 1.0 - most, singles = none + x.x + y.x + z.x + least;
    precise float thirds = (1.0 / 3.0) * singles;
    precise vec3 pairs = vec3(z.y + x.y, x.y + y.y, y.y + z.y), quarters = 0.25 * pairs;
    precise vec3 corner_sum = thirds + quarters;
    precise vec3 alone = none + vec3(x.x, y.x, z.x), first = (2.0 / 3.0) * alone;
    precise vec3 second = 0.5 * vec3(x.y, y.y, z.y), of_edges = first + second;
    precise float third = (4.0 / 9.0) * least;
    of_edges += vec3(third);
    centres(t) = vec4(corner_sum, 0.0);

    for (uint i = 0u; i < columns; ++i) {
        precise float of_a = corner_sum.x * value_of(w[0], i), of_b = corner_sum.y * value_of(w[1], i);
        precise float of_c = corner_sum.z * value_of(w[2], i), two = of_a + of_b, centre = two + of_c;
        for (uint k = 0u; k < 3u && i < 6u; ++k) {  // position and normal bulge with the edges
            if (splits(e[k]) == 0u) continue;
            precise float ends = value_of(w[k], i) + value_of(w[(k + 1u) % 3u], i), half_way = 0.5 * ends;
            precise float outward = value_of(first_row(e[k]) + (splits(e[k]) >> 1), i) - half_way;
            precise float share = of_edges[k] * outward;
            centre += share;
        }
        rows[columns * row + i] = centre;
    }
    vec3 normal = unit(row_of(row, 3u));
    if (least > 0.0) {  // turned to the normal of the surrounding hexagon
        precise vec3 hexagon = vec3(0.0);
        for (uint i = 0u; i < 3u; ++i) {
            precise vec3 corner = relative_positions(v[i]).xyz - relative_positions(v[0]).xyz;
            precise vec3 across = midpoints(e[i]).xyz - midpoints(e[(i + 2u) % 3u]).xyz;
            hexagon += exact_cross(corner, across);
        }
        precise float turned = 3.0 * least;
        normal = unit(interpolate(normal, unit(hexagon), min(1.0, turned)));
    }
    write_row(row, row_of(row, 0u), normal);
}
