import assert from "node:assert/strict";
import { test } from "node:test";
import { speakable } from "kit/speech/speakable";

const SPOKEN: [written: string, spoken: string][] = [
  ["Saved: /home/ada/tactile/cat.yaml.", "Saved: cat.yaml."],
  ["/tmp/data/p.yaml:4:3: parts.9: no part has the key 9", "p.yaml:4:3: parts.9: no part has the key 9"],
  ["“C:\\Users\\Ada\\cat.png” cannot be read", "“cat.png” cannot be read"],
  ["out/still/sheet.png is written", "sheet.png is written"],
  ["tangible_ui.worker.state: it is dark", "it is dark"],
  ["Stiffness 800 N/m at 40 mm/s, and/or 1/2 of it", "Stiffness 800 N/m at 40 mm/s, and/or 1/2 of it"],
  ["Up 1.2 mm: helmet, glass.", "Up 1.2 mm: helmet, glass."],
];

for (const [written, spoken] of SPOKEN) test(`${written} is spoken as ${spoken}`, () => assert.equal(speakable(written), spoken));
