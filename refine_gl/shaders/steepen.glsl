// A vertex: its normal, further from those of its neighbours than it is (refine/beyond/cubic.py).
FOR_EACH(v, vertex_count) {
    precise vec3 around = vec3(0.0);
    for (uint k = neighbour_starts(v); k < neighbour_starts(v + 1u); ++k)
        around += tangent_normals(neighbours(k)).xyz;
    vec3 left = weighed(1.0, tangent_normals(v).xyz, -neighbour_share(v), around);
    steeper(v) = vec4(unit(left), 0.0);
}
