//! The page of a library in a browser.

use super::{batch, json, triangles};
use crate::common::skipped;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A Chromium of this machine.
fn chromium() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&folders).flat_map(|folder| names.map(|name| folder.join(name))).find(|path| path.is_file())
}

/// The document that a browser makes of a page, and what went to its console.
fn opened(browser: &Path, page: &Path) -> (String, Vec<String>) {
    let home = tempfile::tempdir().unwrap();
    let ended = Command::new(browser)
        .args(
            "--headless --no-sandbox --disable-gpu --disable-background-networking --disable-component-update"
                .split(' '),
        )
        .args([
            "--disable-sync",
            "--no-first-run",
            "--enable-logging=stderr",
            "--virtual-time-budget=5000",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", home.path().display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.success(), "{said}");
    let console = said.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect();
    (String::from_utf8(ended.stdout).unwrap(), console)
}

/// Told to the console: each picture that did not load, and the assets' order after one and two clicks on a column's head.
const CLICKS: &str = r#"<script>addEventListener("load", () => {
  for (const image of document.images) if (!image.naturalWidth) console.error("no picture: " + image.src);
  const order = () => [...document.querySelectorAll("tbody tr")].map((row) => row.cells[2].dataset.key).join(" ");
  const head = [...document.querySelectorAll("th button")].find((button) => button.textContent === "asset");
  head.click(); const up = order(); head.click();
  document.body.dataset.told = up + " | " + order();
});</script>"#;

#[test]
fn a_page_opens_without_errors_and_sorts() {
    let Some(browser) = chromium() else { return skipped("no Chromium: the page of a batch is not opened") };
    let folder = triangles(2);
    std::fs::write(folder.path().join("broken.glb"), b"glTF").unwrap();
    let report = folder.path().join("report");
    let (code, value) = json(batch(folder.path(), &[]).arg("--report").arg(&report));
    assert_eq!(code, 6, "{value}");
    let page = report.join("index.html");
    assert_eq!(opened(&browser, &page).1, Vec::<String>::new());
    let text = std::fs::read_to_string(&page).unwrap();
    std::fs::write(&page, text.replace("</body>", &format!("{CLICKS}</body>"))).unwrap();
    let (document, console) = opened(&browser, &page);
    assert_eq!(console, Vec::<String>::new());
    assert!(document.contains("data-told=\"broken.glb t0.obj t1.obj | t1.obj t0.obj broken.glb\""), "{document}");
    // The console is heard: a fault put there by hand.
    std::fs::write(&page, text.replace("</body>", "<script>unheardOf()</script></body>")).unwrap();
    assert!(opened(&browser, &page).1.iter().any(|line| line.contains("unheardOf")), "nothing was heard");
}
