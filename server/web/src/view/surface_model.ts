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
  RedFormat,
  ShaderMaterial,
  Sphere,
  Vector3,
  Vector4,
} from "three";

import type { Numbered } from "../colouring.ts";
import { type Drawable, kValue } from "../mesh/drawable.ts";
import {
  kGhostFragment,
  kGhostVertex,
  kPickFragment,
  kPickVertex,
  kSurfaceFragment,
  kSurfaceVertex,
  kTextureWidth,
} from "./surface_shader.ts";
import type { Palette } from "./palette.ts";

export type Colouring = "plain" | "patch" | "angle" | "ratio" | "surface" | Numbered;
/** The numbers by which the shader knows them. */
const kColourings: Record<Colouring, number> = {
  plain: 0,
  patch: 1,
  angle: 2,
  ratio: 3,
  surface: 4,
  size: 5,
  distance: 5,
  object: 6,
  group: 6,
  material: 6,
};

/** A mesh on the graphics card. */
export class SurfaceModel {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  /** Chosen surfaces, as they are seen through others. */
  readonly ghost: Mesh<BufferGeometry, ShaderMaterial>;
  /** Its edges, to be laid over another surface. */
  readonly overlay: Mesh<BufferGeometry, ShaderMaterial>;
  readonly pickMaterial: ShaderMaterial;
  private texture: DataTexture;
  private numbersTexture: DataTexture | null = null;

  constructor(readonly drawable: Drawable) {
    this.texture = textureOf(drawable.values, kValue.count);
    // Shared, so that what is seen is what is picked.
    const shared = { faces: { value: this.texture }, section: { value: new Vector4(0, 0, 0, 1) } };
    const ofSurfaces = {
      patches: { value: null },
      patchCount: { value: 0 },
      plain: { value: new Color() },
      selectedColour: { value: new Color() },
    };
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kSurfaceVertex,
      fragmentShader: kSurfaceFragment,
      side: DoubleSide,
      uniforms: {
        ...shared,
        ...ofSurfaces,
        hasChosen: { value: false },
        colouring: { value: 0 },
        numbers: { value: null },
        isOverlay: { value: false },
        lineWidth: { value: 1 },
        inside: { value: new Color() },
        lineColour: { value: new Color() },
        featureColour: { value: new Color() },
        openColour: { value: new Color() },
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
    const overlayMaterial = material.clone();
    // A copy shares no textures.
    Object.assign(overlayMaterial.uniforms, shared, ofSurfaces);
    overlayMaterial.uniforms["selectedColour"] = { value: new Color() };
    overlayMaterial.uniforms["isOverlay"]!.value = true;
    overlayMaterial.transparent = true;
    overlayMaterial.depthWrite = false;
    overlayMaterial.polygonOffset = true;
    overlayMaterial.polygonOffsetFactor = -1;
    overlayMaterial.polygonOffsetUnits = -4;
    this.overlay = new Mesh(geometry, overlayMaterial);
    this.overlay.frustumCulled = false;
    const ghostMaterial = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kGhostVertex,
      fragmentShader: kGhostFragment,
      side: DoubleSide,
      transparent: true,
      depthTest: false,
      depthWrite: false,
      uniforms: { ...shared, ...ofSurfaces },
    });
    this.ghost = new Mesh(geometry, ghostMaterial);
    this.ghost.frustumCulled = false;
    this.ghost.visible = false;
  }

  get uniforms(): Record<string, { value: unknown }> {
    return this.mesh.material.uniforms;
  }
  set colouring(colouring: Colouring) {
    this.uniforms["colouring"]!.value = kColourings[colouring];
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
    this.texture = textureOf(values, kValue.count);
    // One object for all materials.
    this.uniforms["faces"]!.value = this.texture;
  }
  /** One for each triangle: from 0 to 1 for colourings with a scale, else a label. */
  set numbers(numbers: Float32Array) {
    this.numbersTexture?.dispose();
    this.numbersTexture = textureOf(numbers, 1);
    this.uniforms["numbers"]!.value = this.numbersTexture;
  }

  /** The texture belongs to the viewer, since both models share it. */
  set patches({ texture, count, hasChosen }: PatchTexture) {
    this.uniforms["patches"]!.value = texture;
    this.uniforms["patchCount"]!.value = count;
    this.uniforms["hasChosen"]!.value = hasChosen;
    this.ghost.visible = hasChosen;
  }

  /** `lineWidth`: in pixels of the canvas; 0: no lines. */
  paint(palette: Palette, lineWidth: number, overlayWidth: number): void {
    this.uniforms["lineWidth"]!.value = lineWidth;
    const ofOverlay = this.overlay.material.uniforms;
    ofOverlay["lineWidth"]!.value = overlayWidth;
    (ofOverlay["selectedColour"]!.value as Color).setStyle(palette.overlay);
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
    this.ghost.material.dispose();
    this.overlay.material.dispose();
    this.numbersTexture?.dispose();
    this.pickMaterial.dispose();
    this.texture.dispose();
  }
}

/** What is told of patches, on the graphics card. */
export interface PatchTexture {
  texture: DataTexture;
  count: number;
  hasChosen: boolean;
}

/** `table`: four bytes for each patch, see patchTable. */
export function patchTextureOf(table: Uint8Array, hasChosen: boolean): PatchTexture {
  const count = table.length / 4;
  const height = Math.max(Math.ceil(count / kTextureWidth), 1);
  const texels = new Uint8Array(4 * kTextureWidth * height);
  texels.set(table);
  const texture = new DataTexture(texels, kTextureWidth, height, RGBAFormat);
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return { texture, count, hasChosen };
}

/** A texel for each triangle, of four numbers or of one. */
function textureOf(values: Float32Array, channels: 1 | 4): DataTexture {
  const height = Math.max(Math.ceil(values.length / channels / kTextureWidth), 1);
  const texels = new Float32Array(kTextureWidth * height * channels);
  texels.set(values);
  const texture = new DataTexture(texels, kTextureWidth, height, channels === 4 ? RGBAFormat : RedFormat, FloatType);
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}
