// A triangle with a point in the middle: its row, by how far the edges have grown, and its shares of
// the corners (refine/beyond/blending.py, surface_normals.py).
vec2 beyond_others(float own, float other, float third) {
    float rival = max(other, third);
    precise float alone = own - rival, pair = min(own, rival) - min(own, min(other, third));
    return vec2(max(alone, 0.0), pair);
}

vec3 mixed_corners(uint a, uint b, uint c, vec3 shares, uint first) {
    precise vec3 of_a = shares.x * row_of(a, first), of_b = shares.y * row_of(b, first);
    precise vec3 of_c = shares.z * row_of(c, first), two = of_a + of_b, three = two + of_c;
    return three;
}

void main() {
    uint t = gl_GlobalInvocationID.x;
    if (t >= face_count || !has_centre(configurations(t))) return;
    uint row = first_centre(t);
    uint v[3], e[3];
    float grown[3];
    for (uint i = 0u; i < 3u; ++i) {
        v[i] = faces(3u * t + i);
        e[i] = triangle_edges(3u * t + i);
        grown[i] = splits(e[i]) > 0u ? edge_normals(e[i]).w : 0.0;
    }
    float least = min(grown[0], min(grown[1], grown[2])), most = max(grown[0], max(grown[1], grown[2]));
    vec2 x = beyond_others(grown[0], grown[1], grown[2]);
    vec2 y = beyond_others(grown[1], grown[2], grown[0]);
    vec2 z = beyond_others(grown[2], grown[0], grown[1]);
    precise float none = 1.0 - most, singles = none + x.x + y.x + z.x + least;
    precise float thirds = (1.0 / 3.0) * singles;
    precise vec3 pairs = vec3(z.y + x.y, x.y + y.y, y.y + z.y), quarters = 0.25 * pairs;
    precise vec3 of_corners = thirds + quarters;
    precise vec3 alone = none + vec3(x.x, y.x, z.x), first = (2.0 / 3.0) * alone;
    precise vec3 second = 0.5 * vec3(x.y, y.y, z.y), of_edges = first + second;
    precise float third = (4.0 / 9.0) * least;
    of_edges += vec3(third);
    centres(t) = vec4(of_corners, 0.0);

    precise vec3 found[2];
    for (uint part = 0u; part < 2u; ++part) {  // position, normal
        precise vec3 centre = mixed_corners(v[0], v[1], v[2], of_corners, 3u * part);
        for (uint i = 0u; i < 3u; ++i) {
            if (splits(e[i]) == 0u) continue;
            uint middle = first_row(e[i]) + (splits(e[i]) >> 1);
            precise vec3 ends = row_of(v[i], 3u * part) + row_of(v[(i + 1u) % 3u], 3u * part);
            precise vec3 half_way = 0.5 * ends, outward = row_of(middle, 3u * part) - half_way;
            precise vec3 share = of_edges[i] * outward;
            centre += share;
        }
        found[part] = centre;
    }
    write_row(row, 0u, found[0]);
    vec3 normal = unit(found[1]);
    if (least > 0.0) {  // towards that of the hexagon around
        precise vec3 hexagon = vec3(0.0);
        for (uint i = 0u; i < 3u; ++i) {
            precise vec3 corner = seen(v[i]).xyz - seen(v[0]).xyz;
            precise vec3 across = middles(e[i]).xyz - middles(e[(i + 2u) % 3u]).xyz;
            hexagon += crossed(corner, across);
        }
        precise float turned = 3.0 * least;
        normal = unit(mixed(normal, unit(hexagon), min(1.0, turned)));
    }
    write_row(row, 3u, normal);
    uint a = corners(3u * t), b = corners(3u * t + 1u), c = corners(3u * t + 2u);
    for (uint i = 6u; i < columns; ++i) {
        precise float of_a = of_corners.x * rows[columns * a + i], of_b = of_corners.y * rows[columns * b + i];
        precise float of_c = of_corners.z * rows[columns * c + i], two = of_a + of_b, three = two + of_c;
        rows[columns * row + i] = three;
    }
}
