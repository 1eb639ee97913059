// The largest depth of all samples in each block of BLOCK x BLOCK pixels.
// SAMPLES: of the layer; 0 = it is not multisampled.

#if defined(VERTEX_STAGE)

void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

#if SAMPLES > 0
uniform sampler2DMS depths;
#else
uniform sampler2D depths;
#endif
uniform ivec2 last;  // pixel of the frame
out float farthest;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * BLOCK;
    farthest = 0.0;
    for (int y = 0; y < BLOCK; y++)
        for (int x = 0; x < BLOCK; x++) {
            ivec2 pixel = min(corner + ivec2(x, y), last);
            for (int i = 0; i < max(SAMPLES, 1); i++)
                farthest = max(farthest, texelFetch(depths, pixel, i).r);
        }
}

#endif
