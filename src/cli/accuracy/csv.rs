//! The table of `umbrage accuracy --csv`: RFC 4180.

use umbrage::accuracy::Question;

use super::FileResult;

const HEADER: &str = "file,what,faces,method,exact,dominated,stratum,queries,ties,judged,wrong,bound_95,median_ns,min_ns,max_ns,prepare_ns_per_face\r\n";

/// A row for each file, method and stratum, and one for all strata together.
pub(super) fn table(results: &[FileResult], question: Question) -> String {
    let mut text = HEADER.to_owned();
    for result in results {
        let Ok(measured) = &result.measured else { continue };
        for method in &measured.found.methods {
            for row in method.strata.iter().chain([&method.total]) {
                let time = |ns: f64| format!("{ns:.4}");
                let cells = [
                    result.file.to_string_lossy().into_owned(),
                    question.name().to_owned(),
                    measured.faces.to_string(),
                    method.name.to_owned(),
                    method.exact.to_string(),
                    method.dominated.to_string(),
                    row.name.to_owned(),
                    row.queries.to_string(),
                    row.ties.to_string(),
                    row.judged.to_string(),
                    row.wrong.to_string(),
                    row.bound_95().map_or(String::new(), |bound| format!("{bound:e}")),
                    time(row.time.median),
                    time(row.time.min),
                    time(row.time.max),
                    method.prepare_ns.map_or(String::new(), time),
                ];
                text += &cells.map(cell).join(",");
                text += "\r\n";
            }
        }
    }
    text
}

/// In quotes where it would otherwise end early (section 2).
pub(super) fn cell(text: String) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

#[cfg(test)]
mod tests {
    use super::cell;

    #[test]
    fn csv_cells_are_quoted_where_they_would_end_early() {
        for (text, wanted) in [("a b", "a b"), ("a,b", "\"a,b\""), ("a\"b", "\"a\"\"b\""), ("a\r", "\"a\r\"")]
        {
            assert_eq!(cell(text.to_owned()), wanted);
        }
    }
}
