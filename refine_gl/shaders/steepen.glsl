// A vertex: its normal, moved away from the normals of its neighbours (refine/beyond/cubic.py).
FOR_EACH(v, vertex_count) {
    precise vec3 around = vec3(0.0);
    for (uint k = neighbour_starts(v); k < neighbour_starts(v + 1u); ++k)
        around += tangent_normals(neighbours(k)).xyz;
    vec3 left = weighted_sum(1.0, tangent_normals(v).xyz, -neighbour_weights(v), around);
    steepened_normals(v) = vec4(unit(left), 0.0);
}
