/** A row of a form: name, control, unit, help, reset to the default, and complaint. */
import { button } from "kit/elements";
import { t } from "./words";
import { type Row, controlOrYaml } from "./controls";
import { formatRange, type Kind, type Option } from "./kinds";
import type { Plain } from "kit/server/messages";
import { numberText } from "./values";

/** Prefix of the fields' ids; the key follows, as in "field:render.stiffness_n_per_m". */
export const FIELD = "field:";

/** Id of the list of the library's names, which the materials panel fills. */
export const LIBRARY = "materials-library";
const MATERIAL = /^materials\..*\b(default|material)$|^render\.material$/;

/** Returns the value of a key that the document does not set, which may depend on the scene. */
export type DefaultOf = (key: string) => Plain | undefined;

export function rows(defaultOf: DefaultOf): Row {
  const row: Row = (option, id, tell) => {
    const box = document.createElement("div");
    box.className = `field kind-${option.kind.kind}`;
    const control = controlOrYaml(option.kind, id, tell, row);
    const key = id.slice(FIELD.length);
    const label = labelOf(option, id, control.main);
    const reset = button(t("toDefault"), () => {
      tell({ gone: true });
      control.main.focus();
    });
    reset.className = "quiet reset";
    reset.setAttribute("aria-label", t("toDefaultOf", { name: option.title }));
    const hint = helpOf(option, id);
    const complaint = document.createElement("p");
    complaint.id = `${id}-complaint`;
    complaint.className = "bad complaint";
    complaint.hidden = true;
    box.append(label, control.root, reset, complaint, hint.root);
    describe(box, id);
    return {
      root: box,
      show: (value, isSet) => {
        const byDefault = (isSet ? undefined : (value ?? defaultOf(key))) ?? option.byDefault;
        reset.hidden = !isSet || option.byDefault === undefined;
        box.classList.toggle("set", isSet);
        control.show(isSet ? value : byDefault, isSet);
        hint.show(byDefault, isSet);
        describe(box, id);
      },
    };
  };
  return row;
}

/** Connect each control of a row with its help and complaint. */
function describe(box: HTMLElement, id: string): void {
  if (MATERIAL.test(id.slice(FIELD.length))) box.querySelector("input")?.setAttribute("list", LIBRARY);
  for (const each of box.querySelectorAll(":scope > .control :is(input, select), :scope > .control > .group > button")) {
    if (each.closest(".field") === box) each.setAttribute("aria-describedby", `${id}-complaint ${id}-hint`);
  }
}

function labelOf({ title, unit, kind }: Option, id: string, main: HTMLElement): HTMLElement {
  const isGroup = kind.kind === "block" || kind.kind === "tuple" || kind.kind === "list";
  const label = document.createElement(isGroup ? "span" : "label");
  label.className = "name";
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

function helpOf(option: Option, id: string): { root: HTMLElement; show(byDefault: Plain | undefined, isSet: boolean): void } {
  const root = document.createElement("p");
  root.id = `${id}-hint`;
  root.className = "hint";
  const about = document.createElement("span");
  about.textContent = option.about;
  const now = document.createElement("span");
  const range = rangeOf(option.kind, option.unit);
  root.append(about, " ", range && `${range[0].toUpperCase()}${range.slice(1)}. `, now);
  return {
    root,
    show: (byDefault, isSet) => {
      const plain = byDefault === undefined || byDefault === null || typeof byDefault === "object";
      now.textContent = !isSet || plain ? "" : t("default", { value: `${numberText(byDefault, t("none"))} ${option.unit}`.trim() });
    },
  };
}

export function rangeOf(kind: Kind, unit: string): string {
  if (kind.kind === "tuple") {
    const all = kind.parts.map((each) => rangeOf(each, unit));
    return all.every((each) => each === all[0]) ? all[0] : all.join("; ");
  }
  if (kind.kind !== "number") return "";
  const range = formatRange(kind.bounds, unit, t("over"), t("under"), t("to"));
  const words = kind.words.length ? `${range && ", "}${t("or")} ${kind.words.join(", ")}` : "";
  return range + words;
}
