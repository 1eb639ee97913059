// Draws a texture over the whole viewport: a label, or a scene that is enlarged.

#if defined(VERTEX_STAGE)

out vec2 place;  // 0..1

void main() {
    place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

in vec2 place;
uniform sampler2D scene;
out vec4 pixel_colour;

void main() {
    pixel_colour = texture(scene, place);  // software OpenGL has no fast path for textureLod
}

#endif
