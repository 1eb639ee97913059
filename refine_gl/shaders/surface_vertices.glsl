// A vertex: its normal on the surface where every edge is split (refine/beyond/surface_normals.py).
FOR_EACH(v, vertex_count) {
    precise vec3 total = vec3(0.0);
    for (uint k = corner_starts(v); k < corner_starts(v + 1u); ++k) {
        uint corner = vertex_corners(k), t = corner / 3u, i = corner - 3u * t;
        if (triangle_edges(3u * t) == NONE) continue;
        uint after = triangle_edges(corner), before = triangle_edges(3u * t + (i + 2u) % 3u);
        precise vec3 outward = centres(t).xyz - relative_positions(v).xyz;
        precise vec3 across = midpoints(before).xyz - midpoints(after).xyz;
        total += exact_cross(outward, across);
    }
    surface_normals(v) = vec4(unit(total), 0.0);
}
