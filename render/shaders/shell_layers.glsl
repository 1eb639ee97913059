// Heights of the layers of short hair, as fractions of the longest strands, and where hair counts as
// a surface.

const float MEAN = 0.6;     // height of the vertices, as a fraction of the longest strands
const float LOWEST = 0.15;  // height of the first layer, in distances of layers: no gap is below it
const float FRAYED_EDGE = 0.2;   // facing below which frayed outlines have no edge
const float LEAST_FACING = 0.05;  // facing from which on a layer hides all behind it

float layer_place(float number, int layers) {
    return (number + LOWEST) / float(layers);
}

// Height of the layer nearest to MEAN, which is the outline of hair.
float outline_place(int layers) {
    return layer_place(floor(MEAN * float(layers) - LOWEST + 0.5), layers);
}

// Fraction of the strands' density that hides the surface behind. A line of sight that runs along the
// surface passes many strands, so few of them hide it.
float seen_share(float facing) {
    return clamp(2.5 * facing, LEAST_FACING, 1.0);
}

// Whether a pixel shows hair; where hair is thinner, the pixel shows the surface behind.
bool is_hair(float dense, float facing) {
    return dense >= 0.5 * seen_share(facing);
}

// Whether the edge of hair is smoothed here. The hem is not: it fades out, and each layer ends at
// another place there. Nor are outlines that fray, and loose hair beyond half its density. facing:
// negative on the inner side of hair.
// sample_kernels.py has the same numbers.
bool has_edge(float dense, float facing, float fray) {
    return dense >= max(0.9 * seen_share(abs(facing)), -0.5 * fray) && max(facing, 0.0) >= FRAYED_EDGE * fray;
}
