/** Tabs as the ARIA practices have them: arrows move, one tab stop. */
export class Tabs {
  private readonly tabs: HTMLElement[];

  /** `onOpen` is told the id of the panel that is shown. */
  constructor(
    list: HTMLElement,
    private readonly onOpen: (panel: string) => void,
  ) {
    this.tabs = [...list.querySelectorAll<HTMLElement>("[role=tab]")];
    for (const tab of this.tabs) tab.addEventListener("click", () => this.open(tab));
    list.addEventListener("keydown", (event) => {
      const at = this.tabs.indexOf(document.activeElement as HTMLElement);
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (at < 0 || !step) return;
      const next = this.tabs[(at + step + this.tabs.length) % this.tabs.length]!;
      this.open(next);
      next.focus();
      event.preventDefault();
    });
  }

  open(tab: HTMLElement): void {
    this.onOpen(tab.getAttribute("aria-controls")!);
    for (const other of this.tabs) {
      const isOpen = other === tab;
      other.setAttribute("aria-selected", String(isOpen));
      other.tabIndex = isOpen ? 0 : -1;
      document.getElementById(other.getAttribute("aria-controls")!)!.hidden = !isOpen;
    }
  }
}
