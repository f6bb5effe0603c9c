// Lines some pixels wide, a little before the surface that they lie on.
import {
  BufferAttribute,
  Color,
  DoubleSide,
  GLSL3,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  Mesh,
  ShaderMaterial,
  Vector2,
  Vector4,
} from "three";

const kVertex = /* glsl */ `
  uniform vec2 viewport;
  uniform float width;
  in vec3 from;
  in vec3 to;

  void main() {
    vec4 a = projectionMatrix * modelViewMatrix * vec4(from, 1.0);
    vec4 b = projectionMatrix * modelViewMatrix * vec4(to, 1.0);
    // What lies behind the camera has no place on the screen.
    const float near = 1e-6;
    if (a.w < near && b.w > near) a = mix(a, b, (near - a.w) / (b.w - a.w));
    else if (b.w < near && a.w > near) b = mix(b, a, (near - b.w) / (a.w - b.w));
    vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
    vec2 across = dot(along, along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(1.0, 0.0);
    gl_Position = position.x < 0.5 ? a : b;
    gl_Position.xy += across * position.y * width / viewport * gl_Position.w;
    gl_Position.z -= 0.003 * gl_Position.w;
  }
`;
const kFragment = /* glsl */ `
  uniform vec3 tint;
  out vec4 colour;
  void main() { colour = vec4(tint, 1.0); }
`;
/** Two triangles over each segment: which end, and which side of it. */
const kCorners = [0, -1, 0, 1, -1, 0, 1, 1, 0, 0, -1, 0, 1, 1, 0, 0, 1, 0];

export class ThickLines {
  readonly material = new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: kVertex,
    fragmentShader: kFragment,
    side: DoubleSide,
    uniforms: { viewport: { value: new Vector2(1, 1) }, width: { value: 2 }, tint: { value: new Color() } },
  });

  /** Output: what is drawn of the segments, each of which is two points in the frame. */
  meshOf(segments: Float32Array): Mesh {
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(kCorners), 3));
    const ends = new InstancedInterleavedBuffer(segments, 6);
    geometry.setAttribute("from", new InterleavedBufferAttribute(ends, 3, 0));
    geometry.setAttribute("to", new InterleavedBufferAttribute(ends, 3, 3));
    const mesh = new Mesh(geometry, this.material);
    mesh.frustumCulled = false;
    const viewport = new Vector4();
    mesh.onBeforeRender = (renderer) => {
      renderer.getCurrentViewport(viewport);
      (this.material.uniforms["viewport"]!.value as Vector2).set(viewport.z, viewport.w);
      this.material.uniformsNeedUpdate = true;
    };
    return mesh;
  }

  paint(colour: string, width: number): void {
    (this.material.uniforms["tint"]!.value as Color).setStyle(colour);
    this.material.uniforms["width"]!.value = width;
  }
}
