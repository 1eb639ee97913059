// Depth only, seen from the key light.

#if defined(VERTEX_STAGE)

in vec3 in_position;
uniform mat4 light_matrix;

void main() {
    gl_Position = light_matrix * vec4(in_position, 1.0);
}

#elif defined(FRAGMENT_STAGE)

void main() {}

#endif
