//! A page of tables and charts: one HTML file that needs nothing else.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use super::OutputResult;
use super::atomic::write_atomic;

/// A page.
pub struct Page {
    /// Its title.
    pub title: String,
    /// What it shows, in a sentence or two.
    pub lead: String,
    /// Its parts.
    pub sections: Vec<Section>,
}

/// A part of a page.
pub struct Section {
    /// Its heading.
    pub heading: String,
    /// Remarks, each a line.
    pub notes: Vec<String>,
    /// Pictures as SVG text.
    pub charts: Vec<String>,
    /// A table below them.
    pub grid: Option<Grid>,
}

/// A table.
pub struct Grid {
    /// The names of its columns.
    pub head: Vec<String>,
    /// Its rows, each as long as the head.
    pub rows: Vec<Vec<Cell>>,
    /// How many columns from the left hold texts; the rest hold numbers.
    pub texts: usize,
}

/// A cell of a table.
pub struct Cell {
    text: String,
    tone: Tone,
}

/// How a cell is coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// As all others.
    Plain,
    /// A target was met.
    Good,
    /// A target was missed.
    Bad,
}

impl Cell {
    /// A cell as all others.
    pub fn plain(text: String) -> Self {
        Cell { text, tone: Tone::Plain }
    }

    /// A cell in a tone.
    pub fn toned(text: String, tone: Tone) -> Self {
        Cell { text, tone }
    }
}

const STYLE: &str = "
:root{--ink:#1c2430;--soft:#5b6675;--line:#e3e7ec;--paper:#fff;--ground:#f5f7f9;--good:#0a7a4b;--bad:#b42318}
@media(prefers-color-scheme:dark){:root{--ink:#e6eaf0;--soft:#9aa6b5;--line:#2c3541;--paper:#171d25;--ground:#10151b;--good:#4cc38a;--bad:#ff8a7a}}
*{box-sizing:border-box}body{margin:0;background:var(--ground);color:var(--ink);font:16px/1.5 system-ui,-apple-system,'Segoe UI',sans-serif}
main{max-width:1200px;margin:0 auto;padding:40px 20px 60px}h1{font-size:30px;line-height:1.2;margin:0 0 8px}h2{font-size:21px;margin:0 0 10px}
.lead{color:var(--soft);max-width:75ch;margin:0 0 28px}
section{background:var(--paper);border:1px solid var(--line);border-radius:12px;padding:22px 24px;margin:0 0 22px}
section p{margin:4px 0;color:var(--soft);max-width:85ch}.charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,460px),1fr));gap:18px;margin:16px 0 8px}
svg{width:100%;height:auto;max-width:680px;font-family:inherit}svg text{fill:var(--ink);font-size:13px}svg .tick{fill:var(--soft);font-size:12px}svg .label{font-weight:600;font-size:14px}
svg .grid{stroke:var(--line);stroke-width:1}svg .axis{stroke:var(--soft);fill:none}svg .target{stroke:var(--good);stroke-dasharray:7 5;stroke-width:1.4}
svg .target-name{fill:var(--good);font-size:12px}svg .ours{font-weight:600}svg .theirs{fill:var(--soft);font-size:11px}
.wide{overflow-x:auto;margin-top:14px}table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th{font-weight:600;color:var(--soft);text-align:right;border-bottom:2px solid var(--line);vertical-align:bottom}td{text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th,td{padding:7px 10px}th{white-space:nowrap}.text{text-align:left}tr:last-child td{border-bottom:0}.good{color:var(--good);font-weight:600}.bad{color:var(--bad);font-weight:700}
footer{color:var(--soft);font-size:13px}";

/// Writes a page, all of it or nothing.
///
/// # Errors
/// When the file cannot be written.
pub fn write_page(path: &Path, page: &Page) -> OutputResult<()> {
    let text = render(page);
    write_atomic(path, |file| file.write_all(text.as_bytes()))
}

/// Writes a chart of a page as a picture that stands alone, on white.
///
/// # Errors
/// When the file cannot be written.
pub fn write_chart(path: &Path, chart: &str) -> OutputResult<()> {
    let colours = [
        ("--ink", "#1c2430"),
        ("--soft", "#5b6675"),
        ("--line", "#e3e7ec"),
        ("--good", "#0a7a4b"),
        ("--bad", "#b42318"),
    ];
    let rules = STYLE.lines().filter(|line| line.starts_with("svg")).collect::<String>();
    let style =
        colours.iter().fold(rules, |rules, (name, value)| rules.replace(&format!("var({name})"), value));
    let opening =
        "<svg xmlns=\"http://www.w3.org/2000/svg\" style=\"background:#fff;font-family:sans-serif\" ";
    let alone = chart.replacen("<svg ", opening, 1).replacen('>', &format!("><style>{style}</style>"), 1);
    write_atomic(path, |file| file.write_all(alone.as_bytes()))
}

fn render(page: &Page) -> String {
    let title = escape(&page.title);
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>{title}</title><style>{STYLE}</style></head>\n<body><main><h1>{title}</h1>\
         <p class=\"lead\">{}</p>\n",
        escape(&page.lead)
    );
    for section in &page.sections {
        let _ = write!(html, "<section><h2>{}</h2>", escape(&section.heading));
        for note in &section.notes {
            let _ = write!(html, "<p>{}</p>", escape(note));
        }
        if !section.charts.is_empty() {
            let _ = write!(html, "<div class=\"charts\">{}</div>", section.charts.join("\n"));
        }
        if let Some(grid) = &section.grid {
            html.push_str(&render_grid(grid));
        }
        html.push_str("</section>\n");
    }
    let _ = writeln!(html, "<footer>Meniscus {}</footer></main></body></html>", env!("CARGO_PKG_VERSION"));
    html
}

fn render_grid(grid: &Grid) -> String {
    let kind = |column: usize| if column < grid.texts { "text" } else { "" };
    let head: String = (grid.head.iter().enumerate())
        .map(|(column, name)| format!("<th class=\"{}\">{}</th>", kind(column), escape(name)))
        .collect();
    let mut html = format!("<div class=\"wide\"><table><thead><tr>{head}</tr></thead><tbody>");
    for row in &grid.rows {
        html.push_str("<tr>");
        for (column, cell) in row.iter().enumerate() {
            let tone = match cell.tone {
                Tone::Plain => "",
                Tone::Good => " good",
                Tone::Bad => " bad",
            };
            let _ = write!(html, "<td class=\"{}{tone}\">{}</td>", kind(column), escape(&cell.text));
        }
        html.push_str("</tr>");
    }
    html + "</tbody></table></div>"
}

/// A text that stands for itself in HTML and SVG.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_escapes_its_texts_and_loads_nothing() {
        let rows = vec![vec![Cell::toned("<missed>".to_owned(), Tone::Bad)]];
        let grid = Grid { head: vec!["a & b".to_owned()], rows, texts: 1 };
        let section =
            Section { heading: "One".to_owned(), notes: Vec::new(), charts: Vec::new(), grid: Some(grid) };
        let page = Page { title: "T".to_owned(), lead: String::new(), sections: vec![section] };
        let html = render(&page);
        assert!(html.contains("&lt;missed&gt;") && html.contains("a &amp; b") && html.contains("text bad"));
        assert!(!html.contains("http") && !html.contains("<script"));
    }
}
