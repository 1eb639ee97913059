// A vertex: its normal, the sum of the cross products around it in the order of triangles; for cubic
// edges another normal with the weights of corners at rest, and its position relative to the first
// used vertex, so that a mesh far from the origin loses no precision.
FOR_EACH(v, vertex_count) {
    precise vec3 plain = vec3(0.0), weighted = vec3(0.0);
    for (uint k = corner_starts(v); k < corner_starts(v + 1u); ++k) {
        uint corner = vertex_corners(k), t = corner / 3u;
        uint a = faces(3u * t), b = faces(3u * t + 1u), c = faces(3u * t + 2u);
        precise vec3 normal = exact_cross(between(a, b), between(a, c));
        plain += normal;
#ifdef CURVED
        precise vec3 share = corner_weights(corner) * normal;
        weighted += share;
#endif
    }
    points(v) = vec4(vec3(position(v)), 0.0);
    normals(v) = vec4(unit(plain), 0.0);
#ifdef CURVED
    tangent_normals(v) = vec4(unit(weighted), 0.0);
    relative_positions(v) = vec4(between(first_vertex, v), 0.0);
#endif
}
