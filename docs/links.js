// mdBook writes .html for .md and its pages lie elsewhere: links that lead out of the book, to records, scenes and
// sources, are made to lead from target/book to the files themselves.
const out = path_to_root + "../";
for (const link of document.querySelectorAll("main a")) {
    const to = link.getAttribute("href") ?? "";
    if (to.startsWith(out)) {
        const file = to.slice(out.length).replace(/\.html(?=#|$)/, ".md");
        link.setAttribute("href", `${path_to_root}../../${file}`);
    }
}
