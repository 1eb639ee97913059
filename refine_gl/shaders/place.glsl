// Vertices, those at split edges moved, and the first level of edges: Kahler, Haber, Seidel 2003,
// section 4.2 with Fig. 3. look_up.glsl goes on.
uniform uint frame;

void place_wedge(uint w) {
    uint v = wedge_vertices(w);
    precise vec3 point = points(v).xyz;
    if (moved(v) == frame) {
        // Eight of the ring, filled up with the vertex itself, then the others: refine/mesh/rings.py.
        precise vec3 total = points(near(8u * v)).xyz;
        for (uint k = 1u; k < 8u; ++k) total += points(near(8u * v + k)).xyz;
        for (uint k = ring_starts(v); k < ring_starts(v + 1u); ++k) total += points(others(k)).xyz;
        precise vec3 mine = ring_own(v) * point, theirs = ring_weight(v) * total;
        point = mine + theirs;
    }
    write_row(w, 0u, point);
    write_row(w, 3u, normals(v).xyz);
    for (uint i = 0u; i < value_count; ++i) rows[columns * w + 6u + i] = wedge_values(value_count * w + i);
}

void place_points(uint r) {
    uint split = splits(r);
    if (split == 0u) return;
    uint e = attribute_edges(r), a = edge_points(4u * e), b = edge_points(4u * e + 1u);
    uint c = edge_points(4u * e + 2u), d = edge_points(4u * e + 3u);
    uint row = first_row(r) + (split >> 1);
    precise vec3 ends = points(a).xyz + points(b).xyz, middle = 0.5 * ends;
    if (c != a) {  // not on a border
        precise vec3 sides = points(c).xyz + points(d).xyz, wings = 0.125 * sides;
        middle = 0.375 * ends;
        middle += wings;
    }
    precise vec3 normal = normals(a).xyz + normals(b).xyz;
    if (r < edge_count) middles(e) = vec4(middle, 0.0);
    write_row(row, 0u, middle);
    write_row(row, 3u, unit(normal));
    place_values(r, row, 0.5, 0.5);
}
