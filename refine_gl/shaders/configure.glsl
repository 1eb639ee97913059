// A triangle: its row of the table (section 4.3), and the index of its subtriangles in the group.
void main() {
    uint t = gl_GlobalInvocationID.x, count = 0u;
    if (t < face_count) {
        uint row = 0u, place = 1u;
        for (uint i = 0u; i < 3u; ++i, place *= 3u) {
            uint r = triangle_attribute_edges(3u * t + i) >> 1;
            if (r < attribute_edge_count) row += place * splits(r);
        }
#ifdef COHERENT  // section 4.4: the order of the splits gives the row
        uint next = transitions(27u * states(t) + row);
        if (next >> 16 > 0u) atomicAdd(removals(0u), next >> 16);  // out of order
        states(t) = row = next & 0xffffu;
#endif
        configurations(t) = row;
        count = counts(row);
    }
    uint before = exclusive_sum(count, attribute_edge_blocks);
    if (t < face_count) first_triangles(t) = before;
#ifdef BLENDED  // points in the middle of triangles are numbered after all others
    uint centre = t < face_count ? uint(has_centre(configurations(t))) : 0u;
    before = exclusive_sum(centre, attribute_edge_blocks + face_blocks);
    if (t < face_count) first_centres(t) = before;
#endif
}
