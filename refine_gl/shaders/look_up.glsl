// Whole groups do the same: wedges, points on attribute edges, and triangles by the table.
// Kahler, Haber, Seidel 2003, section 4.3.
void look_up(uint t) {
    uint row = configurations(t), at = first_triangle(t);
    uint numbered[13];
#ifdef BLENDED
    numbered[CENTRE] = first_centre(t);
#endif
    for (uint i = 0u; i < 3u; ++i) {
        numbered[i] = corners(3u * t + i);
        uint side = triangle_attribute_edges(3u * t + i), r = side >> 1, against = side & 1u;
        if (r >= attribute_edge_count) continue;
        uint first = first_row(r);
        numbered[3u + 3u * i] = first + (splits(r) >> 1);  // the only point, or the second
        numbered[4u + 3u * i] = first + 2u * against;
        numbered[5u + 3u * i] = first + 2u - 2u * against;
    }
    for (uint k = 0u; k < counts(row); ++k, ++at) {
        uint three = patterns(most_subtriangles * row + k);
        triangles[3u * at] = numbered[three & 255u];
        triangles[3u * at + 1u] = numbered[(three >> 8) & 255u];
        triangles[3u * at + 2u] = numbered[three >> 16];
        source[at] = t;
    }
}

void main() {
    uint k = gl_LocalInvocationIndex, group = gl_WorkGroupID.x;
    uint wedge_blocks = (wedge_count + uint(GROUP) - 1u) / uint(GROUP);
    if (group < wedge_blocks) {
        uint w = group * uint(GROUP) + k;
        if (w < wedge_count) place_wedge(w);
    } else if (group < wedge_blocks + attribute_edge_blocks) {
        uint r = (group - wedge_blocks) * uint(GROUP) + k;
        if (r < attribute_edge_count) place_points(r);
    } else {
        uint t = (group - wedge_blocks - attribute_edge_blocks) * uint(GROUP) + k;
        if (t < face_count) look_up(t);
    }
}
