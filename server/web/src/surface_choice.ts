// The surfaces of the report on the screen: their colours, and which of them are chosen.
import type { RecognisedSurface, Report, SurfaceKind } from "./service/types.ts";
import { type Rgb, type SurfaceColours, colourOf, coloursOf, patchTable } from "./surfaces/colours.ts";
import { groupSurfaces, kKinds } from "./surfaces/groups.ts";
import type { SurfacesPanel } from "./ui/surfaces_panel.ts";
import type { Viewer } from "./view/viewer.ts";

export class SurfaceChoice {
  private report: Report | null = null;
  private colours: SurfaceColours = new Uint8Array();
  /** The surface of each patch; empty where it is not known to which patch a face belongs. */
  private surfaceOf = new Uint32Array();
  private chosen: ReadonlySet<number> = new Set();

  constructor(
    private readonly viewer: Viewer,
    private readonly panel: SurfacesPanel,
  ) {}

  /** Null where there is no report. */
  tell(report: Report | null): void {
    this.report = report;
    const groups = groupSurfaces(report?.surfaces ?? []);
    this.colours = coloursOf(groups);
    this.surfaceOf = Uint32Array.from(this.areDrawn ? report!.patches : [], ({ surface }) => surface);
    if (report) this.panel.show({ groups, colours: this.colours, areDrawn: this.areDrawn });
    this.choose([]);
  }

  /** An analysis does not tell the patches of faces. */
  private get areDrawn(): boolean {
    return this.report?.output !== undefined;
  }
  /** The kinds that are seen in the views. */
  get kinds(): SurfaceKind[] {
    const present = new Set(this.areDrawn ? this.report!.surfaces.map(({ kind }) => kind) : []);
    return kKinds.filter((kind) => present.has(kind));
  }
  get hasChosen(): boolean {
    return this.chosen.size > 0;
  }
  isChosen({ id }: RecognisedSurface): boolean {
    return this.chosen.has(id);
  }
  colourOf(surface: RecognisedSurface): Rgb {
    return colourOf(this.colours, surface);
  }
  /** Null where it is not known. */
  ofPatch(patch: number): RecognisedSurface | null {
    const surface = this.surfaceOf[patch];
    return surface === undefined ? null : (this.report!.surfaces[surface] ?? null);
  }

  /** Shows the faces of these surfaces in both views, and their numbers in the panel. */
  choose(ids: readonly number[]): void {
    this.chosen = new Set(ids);
    const table = patchTable(this.surfaceOf, this.colours, this.chosen);
    this.viewer.setPatches(table, this.areDrawn && this.hasChosen);
    this.panel.mark(this.chosen);
  }
}
