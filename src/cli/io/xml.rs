//! Texts in files of XML: pictures and meshes.

/// A text as the content or an attribute of an element: marks of XML by their names, and a sign of replacement for each
/// character that no file of XML 1.0 may hold.
pub fn xml_text(text: &str) -> String {
    let mut own = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => own += "&amp;",
            '<' => own += "&lt;",
            '>' => own += "&gt;",
            '"' => own += "&quot;",
            '\t' | '\n' | '\r' => own.push(' '),
            '\0'..' ' | '\u{fffe}' | '\u{ffff}' => own.push('\u{fffd}'),
            letter => own.push(letter),
        }
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_stays_a_text() {
        let text = "<!--<a \"b\" 'c'> & ]]>\u{1}\n\u{2028}`";
        assert_eq!(xml_text(text), "&lt;!--&lt;a &quot;b&quot; 'c'&gt; &amp; ]]&gt;\u{fffd} \u{2028}`");
    }
}
