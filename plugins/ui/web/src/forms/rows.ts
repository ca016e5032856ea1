/** A row of a form: name, control, unit, help, the way back to the default, and what the check complains of. */
import { button } from "../elements";
import { t } from "./words";
import { type Row, tolerant } from "./controls";
import { bounded, type Kind, type Option } from "./kinds";
import type { Plain } from "./schema";
import { asText } from "./values";

/** Of the fields of all forms; what follows is the key, as in "field:render.stiffness_n_per_m". */
export const FIELD = "field:";

/** Of the list of the library's names, which the panel of materials keeps. */
export const LIBRARY = "materials-library";
const MATERIAL = /^materials\..*\b(default|material)$|^render\.material$/;

/** What counts where the document says nothing, which may depend on the scene. */
export type DefaultOf = (key: string) => Plain | undefined;

export function rows(defaultOf: DefaultOf): Row {
  const row: Row = (option, id, tell) => {
    const box = document.createElement("div");
    box.className = `field kind-${option.kind.kind}`;
    const made = tolerant(option.kind, id, tell, row);
    const key = id.slice(FIELD.length);
    const label = named(option, id, made.main);
    const reset = button(t("toDefault"), () => {
      tell({ gone: true });
      made.main.focus();
    });
    reset.className = "quiet reset";
    reset.setAttribute("aria-label", t("toDefaultOf", { name: option.title }));
    const hint = help(option, id);
    const complaint = document.createElement("p");
    complaint.id = `${id}-complaint`;
    complaint.className = "bad complaint";
    complaint.hidden = true;
    box.append(label, made.root, reset, complaint, hint.root);
    describe(box, id);
    return {
      root: box,
      show: (value, isSet) => {
        const byDefault = (isSet ? undefined : (value ?? defaultOf(key))) ?? option.byDefault;
        reset.hidden = !isSet || option.byDefault === undefined;
        box.classList.toggle("set", isSet);
        made.show(isSet ? value : byDefault, isSet);
        hint.show(byDefault, isSet);
        describe(box, id);
      },
    };
  };
  return row;
}

/** Every control of a row tells what helps with it. */
function describe(box: HTMLElement, id: string): void {
  if (MATERIAL.test(id.slice(FIELD.length))) box.querySelector("input")?.setAttribute("list", LIBRARY);
  for (const each of box.querySelectorAll(":scope > .control :is(input, select), :scope > .control > .group > button")) {
    if (each.closest(".field") === box) each.setAttribute("aria-describedby", `${id}-complaint ${id}-hint`);
  }
}

function named({ title, unit, kind }: Option, id: string, main: HTMLElement): HTMLElement {
  const isGroup = kind.kind === "block" || kind.kind === "tuple" || kind.kind === "list";
  const label = document.createElement(isGroup ? "span" : "label");
  label.className = "name";
  label.lang = "en";
  label.id = `${id}-name`;
  label.append(title);
  if (unit) {
    const behind = document.createElement("span");
    behind.className = "unit";
    behind.textContent = ` ${unit}`;
    label.append(behind);
  }
  if (label instanceof HTMLLabelElement) label.htmlFor = id;
  else (main.closest("[role=group]") ?? main).setAttribute("aria-labelledby", label.id);
  return label;
}

function help(option: Option, id: string): { root: HTMLElement; show(byDefault: Plain | undefined, isSet: boolean): void } {
  const root = document.createElement("p");
  root.id = `${id}-hint`;
  root.className = "hint";
  const about = document.createElement("span");
  about.lang = "en";
  about.textContent = option.about;
  const now = document.createElement("span");
  const range = rangeOf(option.kind, option.unit);
  root.append(about, " ", range && `${range[0].toUpperCase()}${range.slice(1)}. `, now);
  return {
    root,
    show: (byDefault, isSet) => {
      const plain = byDefault === undefined || byDefault === null || typeof byDefault === "object";
      now.textContent = !isSet || plain ? "" : t("default", { value: `${asText(byDefault, t("none"))} ${option.unit}`.trim() });
    },
  };
}

export function rangeOf(kind: Kind, unit: string): string {
  if (kind.kind === "tuple") {
    const all = kind.parts.map((each) => rangeOf(each, unit));
    return all.every((each) => each === all[0]) ? all[0] : all.join("; ");
  }
  if (kind.kind !== "number") return "";
  const range = bounded(kind.bounds, unit, t("over"), t("under"), t("to"));
  const words = kind.words.length ? `${range && ", "}${t("or")} ${kind.words.join(", ")}` : "";
  return range + words;
}
