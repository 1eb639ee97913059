// Vertices, points on edges, and triangles by the table: Kahler, Haber, Seidel 2003, section 4.3.
// By the paper's rule (section 4.2 with Fig. 3) vertices at split edges move, and quarters.glsl has
// the second level; on cubic edges (refine/beyond/cubic.py, surface_normals.py) they stay, and all
// points of an edge are displaced by their geomorph weights.
uniform uint frame;

void place_wedge(uint w) {
    uint v = wedge_vertices(w);
#ifdef CURVED
    write_row(w, points(v).xyz, surface_normals(v).xyz);
#else
    vec3 point = points(v).xyz;
    if (moved_frames(v) == frame) {
        // Eight of the ring, filled up with the vertex itself, then the others: refine/mesh/rings.py.
        precise vec3 total = points(ring_neighbours(8u * v)).xyz;
        for (uint k = 1u; k < 8u; ++k) total += points(ring_neighbours(8u * v + k)).xyz;
        for (uint k = ring_starts(v); k < ring_starts(v + 1u); ++k)
            total += points(further_neighbours(k)).xyz;
        point = weighted_sum(ring_own(v), point, ring_weight(v), total);
    }
    write_row(w, point, normals(v).xyz);
#endif
    for (uint i = 0u; i < value_count; ++i) rows[columns * w + 6u + i] = wedge_values(value_count * w + i);
}

#ifdef CURVED
void place_quarter(uint row, uint a, uint b, uint curve, vec3 middle, vec3 normal, float geomorph) {
    vec3 at_a = points(a).xyz;
    precise vec3 full = weighted_sum(0.75, at_a, 0.25, points(b).xyz) + displacements(curve).xyz;
    precise vec3 ends = at_a + middle, half_way = 0.5 * ends, beside = surface_normals(a).xyz + normal;
    write_row(row, interpolate(half_way, full, geomorph), unit(beside));
}
#endif

void place_points(uint r) {
    uint split = splits(r);
    if (split == 0u) return;
    uint e = attribute_edges(r), a = edge_points(4u * e), b = edge_points(4u * e + 1u);
    uint row = first_row(r) + (split >> 1);
    precise vec3 ends = points(a).xyz + points(b).xyz, middle = 0.5 * ends;
#ifdef CURVED
    float once = edge_normals(e).w, twice = displacements(3u * e).w;
    precise vec3 outward = once * displacements(3u * e + 1u).xyz;
    middle += outward;
    precise float turned = 3.0 * once;
    precise vec3 sum = surface_normals(a).xyz + surface_normals(b).xyz;
    vec3 normal = edge_normals(e).xyz;
    if (turned < 1.0) normal = unit(interpolate(unit(sum), normal, turned));
    if (split > 1u) {
        place_quarter(row - 1u, a, b, 3u * e, middle, normal, twice);
        place_quarter(row + 1u, b, a, 3u * e + 2u, middle, normal, twice);
        place_values(r, row - 1u, 0.75, 0.25);
        place_values(r, row + 1u, 0.25, 0.75);
    }
    write_row(row, middle, normal);
#else
    uint c = edge_points(4u * e + 2u), d = edge_points(4u * e + 3u);
    precise vec3 sides = points(c).xyz + points(d).xyz, sum = normals(a).xyz + normals(b).xyz;
    if (c != a) middle = weighted_sum(0.375, ends, 0.125, sides);  // not on a border
    if (r < edge_count) midpoints(e) = vec4(middle, 0.0);
    write_row(row, middle, unit(sum));
#endif
    place_values(r, row, 0.5, 0.5);
}

void look_up(uint t) {
    uint row = configurations(t), at = first_triangle(t);
    uint point_rows[13];
#ifdef BLENDED
    point_rows[CENTRE] = first_centre(t);
#endif
    for (uint i = 0u; i < 3u; ++i) {
        point_rows[i] = corners(3u * t + i);
        uint side = triangle_attribute_edges(3u * t + i), r = side >> 1, against = side & 1u;
        if (r >= attribute_edge_count) continue;
        uint first = first_row(r);
        point_rows[3u + 3u * i] = first + (splits(r) >> 1);  // the only point, or the second
        point_rows[4u + 3u * i] = first + 2u * against;
        point_rows[5u + 3u * i] = first + 2u - 2u * against;
    }
    for (uint k = 0u; k < counts(row); ++k, ++at) {
        uint packed_corners = patterns(most_subtriangles * row + k);
        for (uint i = 0u; i < 3u; ++i)
            triangles[3u * at + i] = point_rows[(packed_corners >> 8u * i) & 255u];
        source[at] = t;
    }
}

void main() {
    uint k = gl_GlobalInvocationID.x;
    if (k < wedge_count) place_wedge(k);
    if (k < attribute_edge_count) place_points(k);
    if (k < face_count) look_up(k);
}
