// A triangle: its middle on the surface where every edge is split (refine/beyond/surface_normals.py).
FOR_EACH(t, face_count) {
    precise vec3 corner_sum = vec3(0.0), midpoint_sum = vec3(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        uint e = triangle_edges(3u * t + k);
        corner_sum += relative_positions(faces(3u * t + k)).xyz;
        if (e != NONE) midpoint_sum += midpoints(e).xyz;
    }
    precise vec3 outward = midpoint_sum - corner_sum;
    centres(t) = vec4(weighted_sum(1.0 / 3.0, corner_sum, 0.511, outward), 0.0);
}
