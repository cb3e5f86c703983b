//! `report.html`: what it holds, that a browser shows it, and `report`, which makes it anew.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Scratch;

const SHORT: [&str; 5] = [
    "run.t_end=0.1",
    "study.methods=[\"rk4\", \"rk45\", \"bdf\"]",
    "study.rtol=[1e-4, 1e-7]",
    "study.steps=[1e-4]",
    "study.repeats=1",
];

/// Elements without content or end tag.
const VOID: [&str; 4] = ["!DOCTYPE", "meta", "img", "wbr"];

fn count(text: &str, part: &str) -> usize {
    text.matches(part).count()
}

/// The tags of a page in order, without the text of style and script; each must be closed.
fn tags(html: &str) -> Vec<&str> {
    let (mut tags, mut open, mut rest) = (Vec::new(), Vec::new(), html);
    while let Some((_, tag)) = rest.split_once('<') {
        let (tag, after) = tag.split_once('>').unwrap();
        let name = tag.split([' ', '\n', '/']).next().unwrap();
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closed before {:.80}", after);
            continue;
        }
        tags.push(tag);
        if !tag.ends_with('/') && !VOID.contains(&name) {
            open.push(name);
        }
        if ["style", "script"].contains(&name) {
            rest = &after[after.find(&format!("</{name}>")).unwrap()..];
        }
    }
    assert!(open.is_empty(), "not closed: {open:?}");
    tags
}

#[test]
fn the_page_of_a_study_is_well_formed_complete_and_loads_nothing() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    let page = scratch.text("out/report.html");
    let tags = tags(&page);
    for tag in &tags {
        assert!(!tag.contains("src=\"http") && !tag.contains("url("), "{tag}");
        assert!(!tag.starts_with("link") && !tag.starts_with("script src"), "{tag}");
        assert!(!tag.starts_with("a ") || tag.contains("#") || tag.contains("figures/"), "{tag}");
    }
    let figures: Vec<String> =
        scratch.files("out").into_iter().filter(|name| name.ends_with(".svg")).collect();
    for file in &figures {
        let name = file.trim_start_matches("figures/").trim_end_matches(".svg");
        assert_eq!(count(&page, &format!("<figure id=\"{name}\">")), 1, "{name}");
    }
    assert_eq!(tags.iter().filter(|tag| tag.starts_with("svg ")).count(), figures.len());
    let table = scratch.table("out/study.csv");
    let runs = &page[page.find("<caption><span>10 runs, in the order").unwrap()..];
    let rows = count(&runs[..runs.find("</table>").unwrap()], "<tr>");
    assert_eq!(rows, 1 + table.rows.len());
    for column in &table.header {
        assert!(page.contains(&format!("<dt>{column}")), "{column}");
    }
    for part in ["h1", "h2", "caption", "rk45", "opt-level", "t_end = 0.1"] {
        assert!(page.contains(part), "{part}");
    }
    // Measured: 0.5 MB; the default study has 1.4 MB.
    assert!(page.len() < 5_000_000, "{}", page.len());
}

#[test]
fn a_report_is_made_anew_from_study_json_to_the_same_bytes() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    let names = scratch.files("out");
    let contents = || -> Vec<_> {
        names.iter().map(|name| fs::read(scratch.path("out").join(name)).unwrap()).collect()
    };
    let before = contents();
    // What it is made of, and what no report needs.
    let kept = ["study.json", "reference.json"];
    for name in names.iter().filter(|name| !kept.contains(&name.as_str())) {
        fs::remove_file(scratch.path("out").join(name)).unwrap();
    }
    scratch.succeed(&["report", "out", "--quiet"]);
    assert_eq!(scratch.files("out"), names);
    for (name, (before, after)) in names.iter().zip(before.iter().zip(contents())) {
        assert!(*before == after, "{name}");
    }
}

#[test]
fn a_directory_without_a_finished_study_has_no_report() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path("out")).unwrap();
    let refused = |part: &str| {
        let ran = scratch.run(&["report", "out"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""));
        assert!(ran.stderr.contains(part), "{}", ran.stderr);
    };
    refused("no study.json and no sweep.json");
    fs::write(scratch.path("out/study.json"), "{\"rows\": []}").unwrap();
    refused("not that of a study");
    scratch.study("out", &SHORT, &["--force"]);
    let unfinished =
        scratch.text("out/study.json").replace("\"finished\": true", "\"finished\": false");
    fs::write(scratch.path("out/study.json"), unfinished).unwrap();
    refused("not finished");
}

/// A headless browser: `CHROME`, or the first of the usual names in `PATH`.
fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let usual = ["chromium", "chromium-browser", "google-chrome"];
    let mut found = std::env::split_paths(&path)
        .flat_map(|dir| usual.map(|name| dir.join(name)))
        .filter(|file| file.is_file());
    std::env::var_os("CHROME").map(PathBuf::from).or_else(|| found.next())
}

/// The page as the browser has it once its scripts ran, and what they said.
fn shown(browser: &Path, scratch: &Scratch, page: &Path) -> (String, String) {
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--enable-logging=stderr", "--timeout=60000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", scratch.path("browser").display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let [dom, log] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    (dom, log.lines().filter(|line| line.contains("CONSOLE")).collect())
}

#[test]
fn a_browser_shows_the_page_sorts_its_tables_and_has_nothing_to_complain_of() {
    let Some(browser) = browser() else {
        println!("skipped: no chromium, chromium-browser or google-chrome in PATH, nor CHROME set");
        return;
    };
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    // Presses the head of column e of all runs twice, as a reader who looks for the worst.
    let presses = "<script>{\
        const table = [...document.querySelectorAll('table')].find(t => t.rows.length === 11);\
        const head = [...table.rows[0].cells].find(c => c.textContent === 'e');\
        for (const _ of [1, 2]) head.querySelector('button').click();\
        const column = head.cellIndex;\
        const cells = [...table.rows].slice(1).map(row => row.cells[column].textContent);\
        document.title = cells.join(' ');\
        document.body.dataset.wider = document.documentElement.scrollWidth > innerWidth;\
    }</script></body>";
    let page = scratch.text("out/report.html").replace("</body>", presses);
    fs::write(scratch.path("out/pressed.html"), &page).unwrap();
    let (dom, complaints) = shown(&browser, &scratch, &scratch.path("out/pressed.html"));
    assert_eq!(complaints, "");
    assert_eq!(count(&dom, "data-sortable"), count(&page, "<table"));
    let (_, body) = dom.split_once("<body").unwrap();
    assert_eq!(count(body, "aria-sort=\"descending\""), 1);
    assert!(dom.contains("data-wider=\"false\""), "the page is no wider than its window");
    let title = &dom[dom.find("<title>").unwrap() + 7..dom.find("</title>").unwrap()];
    let sorted: Vec<f64> = title.split(' ').map(|e| e.parse().unwrap()).collect();
    assert_eq!(sorted.len(), 10);
    assert!(sorted.is_sorted_by(|a, b| a >= b), "{title}");
}
