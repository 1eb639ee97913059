// An attribute edge that is split twice: its quarter points, and its moved midpoint (Fig. 4).
vec3 wing(uint u, uint v, uint e) {  // the midpoint of a neighbour edge, on the straight edge if it is not split
    if (splits(e) > 0u) return midpoints(e).xyz;
    precise vec3 straight = 0.5 * (points(u).xyz + points(v).xyz);
    return straight;
}

FOR_EACH(r, attribute_edge_count) {
    if (splits(r) < 2u) return;
    uint e = attribute_edges(r), a = edge_points(4u * e), b = edge_points(4u * e + 1u);
    uint c = edge_points(4u * e + 2u), d = edge_points(4u * e + 3u), row = first_row(r);
    precise vec3 m = midpoints(e).xyz, at_a = row_of(a, 0u), at_b = row_of(b, 0u);
    precise vec3 ends_a = at_a + m, ends_b = at_b + m, ends = at_a + at_b;
    precise vec3 beside_a = 0.5 * ends_a, beside_b = 0.5 * ends_b;
    vec3 middle = weighted_sum(0.75, m, 0.125, ends);
    if (c != a) {  // not on a border
        precise vec3 p = wing(a, c, wings(4u * e)), q = wing(b, c, wings(4u * e + 1u));
        precise vec3 s = wing(a, d, wings(4u * e + 2u)), t = wing(b, d, wings(4u * e + 3u));
        precise vec3 wings_a = p + s, wings_b = q + t, all = wings_a + wings_b, ring = ends + all;
        beside_a = weighted_sum(0.375, ends_a, 0.125, wings_a);
        beside_b = weighted_sum(0.375, ends_b, 0.125, wings_b);
        middle = weighted_sum(0.625, m, 0.0625, ring);
    }
    precise vec3 at_middle = row_of(row + 1u, 3u);
    precise vec3 normal_a = row_of(a, 3u) + at_middle, normal_b = row_of(b, 3u) + at_middle;
    write_row(row, beside_a, unit(normal_a));
    write_row(row + 1u, middle, at_middle);
    write_row(row + 2u, beside_b, unit(normal_b));
    place_values(r, row, 0.75, 0.25);
    place_values(r, row + 2u, 0.25, 0.75);
}
