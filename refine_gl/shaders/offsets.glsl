// One group: from sums within blocks to sums over all, and the command that draws the frame.
uint sum_blocks(uint first, uint count, uint start) {  // exclusive sums in place; returns the total
    for (uint base = 0u; base < count; base += uint(GROUP)) {
        uint k = base + gl_LocalInvocationIndex;
        uint value = k < count ? blocks(first + k) : 0u;
        uint sum = inclusive_sum(value);
        uint most = sums[GROUP - 1];
        barrier();
        if (k < count) blocks(first + k) = start + sum - value;
        start += most;
    }
    return start;
}

void main() {
    uint row_count = sum_blocks(0u, attribute_edge_blocks, wedge_count);
    uint triangle_count = sum_blocks(attribute_edge_blocks, face_blocks, 0u);
#ifdef BLENDED
    row_count = sum_blocks(attribute_edge_blocks + face_blocks, face_blocks, row_count);
#endif
    if (gl_LocalInvocationIndex == 0u) {
        command[0] = 3u * triangle_count;  // of DrawElementsIndirectCommand: indices, one instance
        command[1] = 1u;
        command[2] = command[3] = command[4] = 0u;
        command[5] = row_count;
        command[6] = triangle_count;
    }
}
