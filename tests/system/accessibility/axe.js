// Has axe-core, which is loaded already, look over the page that it runs in, and gives what it finds wrong, in words.
(async () => {
  const TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"];
  /** Rules that the pages do not follow, by their ids, each with the reason. */
  const EXCEPTIONS = {};
  const { violations } = await axe.run(document, {
    runOnly: { type: "tag", values: TAGS },
    rules: Object.fromEntries(Object.keys(EXCEPTIONS).map((rule) => [rule, { enabled: false }])),
    resultTypes: ["violations"],
    // A page within the page is of another site, which answers nobody: it is looked over by itself.
    iframes: false,
  });
  const tell = ({ id, help }, { html, failureSummary }) => `${id} (${help}): ${html.slice(0, 160)}: ${failureSummary.replace(/\s+/g, " ")}`;
  return violations.flatMap((rule) => rule.nodes.map((node) => tell(rule, node)));
})()
