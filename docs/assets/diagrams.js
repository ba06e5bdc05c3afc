// Draws the Mermaid diagrams of a page, in the colours of the scheme that is on.
if (document.querySelector(".diagram")) {
  const { mermaid } = await import("./mermaid/index.js");
  const dark = document.body.dataset.mdColorScheme === "slate";
  mermaid.initialize({ startOnLoad: false, theme: dark ? "dark" : "default" });
  await mermaid.run({ querySelector: ".diagram" });
}
