// An edge: the normal in its middle on the surface where every edge is split, and the change by a
// split (refine/beyond/surface_normals.py, displacement.py).
const float STEADY = 0.02;

FOR_EACH(e, edge_count) {
    uint a = edge_points(4u * e), b = edge_points(4u * e + 1u);
    uint side = edge_sides(2u * e) >> 2, other = edge_sides(2u * e + 1u) >> 2;
    precise vec3 ends = surface_normals(a).xyz + surface_normals(b).xyz, mean = 0.5 * ends;
    precise vec3 along = seen(b).xyz - seen(a).xyz;
    vec3 normal;
    if (edge_points(4u * e + 2u) == a && other < face_count) {
        normal = unit(mean);  // sheets that meet have no normal in common
    } else {
        vec3 far = other < face_count ? centres(other).xyz : middles(e).xyz;
        precise vec3 across = centres(side).xyz - far;
        precise float share = STEADY * dotted(along, along);
        normal = unit(weighed(1.0, crossed(along, across), share, mean));
    }
    precise vec3 straight = seen(a).xyz + seen(b).xyz, half_way = 0.5 * straight;
    precise vec3 outward = middles(e).xyz - half_way, apart = normal - unit(ends);
    float size = length_of(outward);
    precise float product = dotted(apart, apart) * dotted(along, along);
    precise float turn = turning * root_of(product), squares = size * size + turn * turn;
    edge_normals(e) = vec4(normal, 0.0);
    middles(e).w = turning > 0.0 ? root_of(squares) : size;
}
