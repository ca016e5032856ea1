import { words } from "../words/words";

/** Notices over the surface. */
export const t = words({
  edges: ["This relief comes from edges, not from depth.", "Dieses Relief entsteht aus Kanten, nicht aus Tiefe."],
  photograph: ["This relief comes from brightness, not from depth.", "Dieses Relief entsteht aus Helligkeit, nicht aus Tiefe."],
  edgesSays: ["One photograph does not tell what is in front: every line of the picture is felt as a ridge.",
    "Ein einzelnes Foto verrät nicht, was vorn ist: Jede Linie des Bildes ist als Kante zu fühlen."],
  photographSays: ["One photograph does not tell what is in front: light places are felt as high, dark ones as low.",
    "Ein einzelnes Foto verrät nicht, was vorn ist: Helles ist als hoch zu fühlen, Dunkles als tief."],
  draw: ["Draw its parts", "Teile zeichnen"],
  how: ["How to get depth", "Wie man Tiefe bekommt"],
  dismiss: ["Close this note", "Hinweis schließen"],
  byParts: ["Draw the parts of the picture, and give each a height: that takes a few minutes, and any picture will do.",
    "Zeichnen Sie die Teile des Bildes, und geben Sie jedem eine Höhe: Das dauert ein paar Minuten und geht mit jedem Bild."],
  byPair: ["Take a second photograph from a hand's breadth further right, and open both together as left and right picture.",
    "Nehmen Sie ein zweites Foto auf, eine Handbreit weiter rechts, und öffnen Sie beide zusammen als linkes und rechtes Bild."],
  byMap: ["Open a height map, or a picture of depths from a camera that measures them.",
    "Öffnen Sie eine Höhenkarte oder ein Tiefenbild von einer Kamera, die Tiefe misst."],
  byNetwork: ["Let a network guess the depth: the page “Learned depth” of the documentation says which, and how.",
    "Lassen Sie ein Netz die Tiefe schätzen: Die Seite „Learned depth“ der Dokumentation sagt, welches und wie."],
  pending: ["The surface under the hand is older than the last change.", "Zu fühlen ist, was vor der letzten Änderung berechnet wurde."],
  make: ["Make and feel", "Berechnen und fühlen"],
  undo: ["Undo", "Rückgängig"],
});
