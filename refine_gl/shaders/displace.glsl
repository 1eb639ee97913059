// An edge: the displacements of its three points on a cubic curve, which is normal to the normals at
// its ends, or follows the border; and its midpoint on the surface where every edge is split.
// Vlachos, Peters, Boyd, Mitchell 2001, as in refine/beyond/cubic.py.
const float FULLNESS = 1.2, TINIEST = 1.17549435e-38;

float share_of(float size, float other) {
    precise float both = size + other;
    return float(double(size) / double(max(both, TINIEST)));
}

FOR_EACH(e, edge_count) {
    uint a = edge_points(4u * e), b = edge_points(4u * e + 1u);
    vec3 d = between(a, b);
    precise vec3 turn_a, turn_b;
    if (edge_points(4u * e + 2u) != a) {  // not on a border
        vec3 at_a = steepened_normals(a).xyz, at_b = steepened_normals(b).xyz;
        precise float height_a = -FULLNESS * exact_dot(d, at_a), height_b = -FULLNESS * exact_dot(d, at_b);
        turn_a = height_a * at_a;
        turn_b = height_b * at_b;
    } else {
        uint p = border_neighbours(2u * e), q = border_neighbours(2u * e + 1u);
        float size = exact_length(d);
        precise vec3 along_a = share_of(size, exact_length(between(p, a))) * between(p, b);
        precise vec3 along_b = share_of(size, exact_length(between(b, q))) * between(a, q);
        turn_a = along_a - d;
        turn_b = along_b - d;
        if (p == a) turn_a = -turn_b;
        else if (q == b) turn_b = -turn_a;
    }
    precise vec3 difference = turn_a - turn_b, middle = 0.125 * difference;
    displacements(3u * e) = vec4(weighted_sum(0.140625, turn_a, -0.046875, turn_b), 0.0);
    displacements(3u * e + 1u) = vec4(middle, 0.0);
    displacements(3u * e + 2u) = vec4(weighted_sum(0.046875, turn_a, -0.140625, turn_b), 0.0);
    precise vec3 ends = relative_positions(a).xyz + relative_positions(b).xyz;
    precise vec3 straight = 0.5 * ends, whole = straight + middle;
    midpoints(e) = vec4(whole, 0.0);
}
