// Vertices as they are, and points on cubic edges as far as they have grown (refine/beyond/cubic.py,
// surface_normals.py). look_up.glsl goes on.
void place_wedge(uint w) {
    uint v = wedge_vertices(w);
    write_row(w, 0u, points(v).xyz);
    write_row(w, 3u, surface_normals(v).xyz);
    for (uint i = 0u; i < value_count; ++i) rows[columns * w + 6u + i] = wedge_values(value_count * w + i);
}

void place_quarter(uint row, vec3 at_a, vec3 at_b, vec3 middle, vec3 outward, float grown) {
    precise vec3 near = 0.75 * at_a, far = 0.25 * at_b, straight = near + far, full = straight + outward;
    precise vec3 ends = at_a + middle, half_way = 0.5 * ends;
    write_row(row, 0u, mixed(half_way, full, grown));
}

void place_points(uint r) {
    uint split = splits(r);
    if (split == 0u) return;
    uint e = attribute_edges(r), a = edge_points(4u * e), b = edge_points(4u * e + 1u);
    uint row = first_row(r) + (split >> 1);
    float once = edge_normals(e).w, twice = displaced(3u * e).w;
    vec3 at_a = points(a).xyz, at_b = points(b).xyz;
    precise vec3 ends = at_a + at_b, straight = 0.5 * ends, outward = once * displaced(3u * e + 1u).xyz;
    precise vec3 middle = straight + outward;
    vec3 normal_a = surface_normals(a).xyz, normal_b = surface_normals(b).xyz;
    vec3 normal = edge_normals(e).xyz;
    precise float turned = 3.0 * once;
    turned = min(1.0, turned);
    if (turned < 1.0) {
        precise vec3 sum = normal_a + normal_b;
        normal = unit(mixed(unit(sum), normal, turned));
    }
    write_row(row, 0u, middle);
    write_row(row, 3u, normal);
    place_values(r, row, 0.5, 0.5);
    if (split < 2u) return;
    place_quarter(row - 1u, at_a, at_b, middle, displaced(3u * e).xyz, twice);
    place_quarter(row + 1u, at_b, at_a, middle, displaced(3u * e + 2u).xyz, twice);
    precise vec3 beside_a = normal_a + normal, beside_b = normal_b + normal;
    write_row(row - 1u, 3u, unit(beside_a));
    write_row(row + 1u, 3u, unit(beside_b));
    place_values(r, row - 1u, 0.75, 0.25);
    place_values(r, row + 1u, 0.25, 0.75);
}
