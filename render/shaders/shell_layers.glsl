// Places of the layers of short hair on the way of its strands, and where hair counts as a surface.

const float MEAN = 0.6;     // of the strands' way to the tips of the longest; vertices lie there
const float LOWEST = 0.15;  // place of the first layer, beside their distance: no gap is below it
const float LEAST_FACING = 0.05;  // from which on all of a layer is passed

float layer_place(float number, int layers) {
    return (number + LOWEST) / float(layers);
}

// The layer about the mean, for any number of layers: the outline of hair.
float outline_place(int layers) {
    return layer_place(floor(MEAN * float(layers) - LOWEST + 0.5), layers);
}

// Seen from the side, a look goes past many strands.
float seen_share(float facing) {
    return clamp(2.5 * facing, LEAST_FACING, 1.0);
}

// Where there are fewer strands a pixel shows the surface behind.
bool is_hair(float dense, float facing) {
    return dense >= 0.5 * seen_share(facing);
}

// Where hair has an edge that is smoothed. Its hem has none: it fades by itself, and layers end there
// at other places each. sample_kernels.py has the same number.
bool has_edge(float dense, float facing) {
    return dense >= 0.9 * seen_share(facing);
}
