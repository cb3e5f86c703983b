//! Pages, links, anchors, pictures.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use crate::{Page, file, pages, root};

/// The targets of links and pictures in prose, code taken off.
fn targets(page: &Page) -> Vec<String> {
    let (_, prose) = page.parts();
    let text: String = prose.join("\n").split('`').step_by(2).collect();
    let after = text.split("](").skip(1);
    after.map(|rest| rest.split(')').next().unwrap().to_owned()).collect()
}

/// A path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                assert!(plain.pop(), "{} leaves the repository", path.display())
            }
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}

/// The names by which the headings of a page are linked to: small letters, digits, `_`, `-`, and `-` for a space.
fn anchors(text: &str) -> BTreeSet<String> {
    let page = Page { path: String::new(), text: text.to_owned() };
    let (_, prose) = page.parts();
    let headings = prose.iter().filter(|line| line.starts_with('#'));
    let anchor = |heading: &&str| {
        let kept = heading.trim_start_matches('#').trim().chars().filter_map(|c| match c {
            ' ' => Some('-'),
            c if c.is_alphanumeric() || c == '_' || c == '-' => Some(c),
            _ => None,
        });
        kept.collect::<String>().to_lowercase()
    };
    headings.map(anchor).collect()
}

#[test]
fn every_page_of_docs_is_in_the_summary_and_every_chapter_is_there() {
    let all = pages();
    let (own, rest): (Vec<&Page>, Vec<&Page>) =
        all.iter().partition(|page| page.path == "docs/SUMMARY.md");
    let chapters: Vec<String> =
        targets(own[0]).iter().map(|target| format!("docs/{target}")).collect();
    let named: BTreeSet<&str> = chapters.iter().map(String::as_str).collect();
    assert_eq!(named.len(), chapters.len(), "a chapter stands twice: {chapters:?}");
    let pages = rest.iter().map(|page| page.path.as_str());
    let pages: BTreeSet<&str> = pages.filter(|path| path.starts_with("docs/")).collect();
    assert_eq!(named, pages);
}

#[test]
fn every_link_and_picture_leads_somewhere() {
    let mut n_anchors = 0;
    for page in pages() {
        for target in targets(&page) {
            if target.starts_with("https://") {
                continue;
            }
            let (path, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let folder = Path::new(&page.path).parent().unwrap();
            let to =
                if path.is_empty() { PathBuf::from(&page.path) } else { plain(&folder.join(path)) };
            assert!(root().join(&to).exists(), "{}: {target}", page.path);
            let is_page = to.extension().is_some_and(|extension| extension == "md");
            // A book writes links to pages anew, as to .html, and has those of docs alone.
            let is_lost = page.path.starts_with("docs/") && is_page && !to.starts_with("docs");
            assert!(!is_lost, "{}: {target} is no page of the guide", page.path);
            if !anchor.is_empty() {
                n_anchors += 1;
                let there = anchors(&file(to.to_str().unwrap()));
                assert!(there.contains(anchor), "{}: {target}; there are {there:?}", page.path);
            }
        }
    }
    assert!(n_anchors > 10, "{n_anchors}");
}

/// Folders of the repository that no path in words leads into.
const BUILT: [&str; 2] = ["target", "book"];

#[test]
fn every_path_in_words_is_one() {
    let mut n_paths = 0;
    for page in pages() {
        let prose = page.parts().1.join("\n");
        let spans = prose.split('`').skip(1).step_by(2);
        // Some have a part that stands for a name.
        let stands_for_many =
            |span: &str| span.contains(['*', '…', '\n', ' ']) || span.contains("NAME");
        for span in spans.filter(|span| !stands_for_many(span)) {
            let Some((folder, _)) = span.split_once('/') else { continue };
            if !folder.is_empty() && root().join(folder).is_dir() && !BUILT.contains(&folder) {
                assert!(root().join(span).exists(), "{}: {span}", page.path);
                n_paths += 1;
            }
        }
    }
    assert!(n_paths > 50, "{n_paths}");
}

#[test]
fn an_anchor_is_made_of_its_heading_as_mdbook_makes_it() {
    let text = "# The columns of runs.csv\n\n```sh\n# no heading\n```\n## `a_b`: how, and why?\n";
    let expected = ["the-columns-of-runscsv", "a_b-how-and-why"].map(str::to_owned);
    assert_eq!(anchors(text), BTreeSet::from(expected));
}
