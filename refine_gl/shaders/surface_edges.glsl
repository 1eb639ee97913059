// An edge: the normal in its middle on the surface where every edge is split, and the change by a
// split (refine/beyond/surface_normals.py, displacement.py).
const float STEADY = 0.02;

FOR_EACH(e, edge_count) {
    uint a = edge_points(4u * e), b = edge_points(4u * e + 1u);
    uint side = edge_sides(2u * e) >> 2, other = edge_sides(2u * e + 1u) >> 2;
    precise vec3 ends = surface_normals(a).xyz + surface_normals(b).xyz, mean = 0.5 * ends;
    precise vec3 along = relative_positions(b).xyz - relative_positions(a).xyz;
    vec3 normal;
    if (edge_points(4u * e + 2u) == a && other < face_count) {
        normal = unit(mean);  // sheets that meet have no common normal
    } else {
        vec3 far = other < face_count ? centres(other).xyz : midpoints(e).xyz;
        precise vec3 across = centres(side).xyz - far;
        precise float share = STEADY * exact_dot(along, along);
        normal = unit(weighted_sum(1.0, exact_cross(along, across), share, mean));
    }
    precise vec3 straight = relative_positions(a).xyz + relative_positions(b).xyz, half_way = 0.5 * straight;
    precise vec3 outward = midpoints(e).xyz - half_way, apart = normal - unit(ends);
    float size = exact_length(outward);
    precise float product = exact_dot(apart, apart) * exact_dot(along, along);
    precise float turn = turning * exact_root(product), squares = size * size + turn * turn;
    edge_normals(e) = vec4(normal, 0.0);
    midpoints(e).w = turning > 0.0 ? exact_root(squares) : size;
}
