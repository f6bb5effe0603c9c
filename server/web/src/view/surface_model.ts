import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DoubleSide,
  FloatType,
  GLSL3,
  Mesh,
  NearestFilter,
  RGBAFormat,
  ShaderMaterial,
  Sphere,
  Vector3,
  Vector4,
} from "three";

import { type Drawable, kValue } from "../mesh/drawable.ts";
import { kPickFragment, kPickVertex, kSurfaceFragment, kSurfaceVertex, kTextureWidth } from "./surface_shader.ts";
import type { Palette } from "./palette.ts";

export type Colouring = "plain" | "patch" | "angle" | "ratio";
const kColourings: Colouring[] = ["plain", "patch", "angle", "ratio"];

/** A mesh on the graphics card. */
export class SurfaceModel {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  readonly pickMaterial: ShaderMaterial;
  private texture: DataTexture;

  constructor(readonly drawable: Drawable) {
    this.texture = textureOf(drawable.values);
    // Shared, so that what is seen is what is picked.
    const shared = { faces: { value: this.texture }, section: { value: new Vector4(0, 0, 0, 1) } };
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kSurfaceVertex,
      fragmentShader: kSurfaceFragment,
      side: DoubleSide,
      uniforms: {
        ...shared,
        colouring: { value: 0 },
        lineWidth: { value: 1 },
        plain: { value: new Color() },
        inside: { value: new Color() },
        lineColour: { value: new Color() },
        featureColour: { value: new Color() },
        openColour: { value: new Color() },
        selectedColour: { value: new Color() },
        keptColour: { value: new Color() },
        scale: { value: Array.from({ length: 5 }, () => new Color()) },
        selected: { value: -1 },
        showsKept: { value: true },
      },
    });
    this.pickMaterial = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kPickVertex,
      fragmentShader: kPickFragment,
      side: DoubleSide,
      uniforms: shared,
    });
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(drawable.positions, 3));
    geometry.boundingSphere = new Sphere(new Vector3(), 2);
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
  }

  get uniforms(): Record<string, { value: unknown }> {
    return this.mesh.material.uniforms;
  }
  set colouring(colouring: Colouring) {
    this.uniforms["colouring"]!.value = kColourings.indexOf(colouring);
  }
  set section(plane: Vector4) {
    (this.uniforms["section"]!.value as Vector4).copy(plane);
  }
  set selected(triangle: number) {
    this.uniforms["selected"]!.value = triangle;
  }
  set values(values: Float32Array) {
    this.drawable.values = values;
    this.texture.dispose();
    this.texture = textureOf(values);
    this.uniforms["faces"]!.value = this.texture;
  }

  paint(palette: Palette): void {
    const set = (name: string, colour: string): void => {
      (this.uniforms[name]!.value as Color).setStyle(colour);
    };
    set("plain", palette.plain);
    set("inside", palette.inside);
    set("lineColour", palette.line);
    set("featureColour", palette.feature);
    set("openColour", palette.open);
    set("selectedColour", palette.selected);
    set("keptColour", palette.kept);
    (this.uniforms["scale"]!.value as Color[]).forEach((colour, i) => colour.setStyle(palette.scale[i]!));
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.pickMaterial.dispose();
    this.texture.dispose();
  }
}

function textureOf(values: Float32Array): DataTexture {
  const height = Math.max(Math.ceil(values.length / kValue.count / kTextureWidth), 1);
  const texels = new Float32Array(kTextureWidth * height * kValue.count);
  texels.set(values);
  const texture = new DataTexture(texels, kTextureWidth, height, RGBAFormat, FloatType);
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}
