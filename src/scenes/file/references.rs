//! Names of other entries, and of their nodes; in which order they are made.

use super::fields::{Item, NodePlace, Value};
use super::order::ordered;
use super::raw::Raw;
use super::reader::Reader;
use super::section::Section;
use crate::scenes::unknown;

impl Reader {
    /// Names of the entries of some sections.
    pub(super) fn names_of(&self, is_of: impl Fn(&Section) -> bool) -> Vec<String> {
        let own = self.declared.iter().filter(|own| is_of(own.section) && !own.name.is_empty());
        own.map(|own| own.name.clone()).collect()
    }

    /// The entry with a name, of some sections.
    fn find_where(&self, name: &str, is_of: impl Fn(&Section) -> bool) -> Option<usize> {
        let named = self.by_name.get(name)?;
        named.iter().copied().find(|&place| is_of(self.declared[place].section))
    }

    /// The same of sections by their names, the first of them first.
    pub(super) fn find(&self, name: &str, sections: &[&str]) -> Option<usize> {
        sections.iter().find_map(|section| self.find_where(name, |own| own.name == *section))
    }

    pub(super) fn item(&mut self, raw: &Raw, what: &str, sections: &[&str]) -> Option<usize> {
        let wanted = sections.join(", ");
        let name = raw.text().or_else(|| self.not(raw, what, &format!("the name of a {wanted}")))?;
        let found = self.find(name, sections);
        if found.is_none() && !self.names_are_missing {
            let mut names = self.names_of(|own| sections.contains(&own.name));
            if sections.contains(&"mesh") {
                names.extend(self.group_names());
            }
            let text = match self.declared.iter().find(|own| own.name == name) {
                Some(other) => {
                    let (is, wanted) = (other.section.name, sections.join(" or "));
                    let there =
                        if names.is_empty() { "there is none".into() } else { format!("there are: {}", names.join(", ")) };
                    format!("\"{name}\" is a {is}, and a {wanted} is wanted here; {there}")
                }
                None => unknown(sections[0], name, &names),
            };
            self.wrong(raw.at, format!("{what}: {text}"));
        }
        found
    }

    /// The same, or a group of the faces of a mesh: `plate.web`.
    pub(super) fn item_or_group(&mut self, raw: &Raw, what: &str, sections: &[&str]) -> Option<Value> {
        if let Some(text) = raw.text().filter(|text| sections.contains(&"mesh") && self.find(text, sections).is_none())
            && let Some((item, rest)) = self.of_mesh(text)
            && let Some(group) = rest.strip_prefix('.')
        {
            // a mesh that could not be read has been reported
            let known = self.declared[item].mesh.as_ref().is_none_or(|data| data.group(group).is_some());
            if known {
                return Some(Value::Item(item, Some(group.into())));
            }
        }
        self.item(raw, what, sections).map(|item| Value::Item(item, None))
    }

    pub(super) fn node(&mut self, raw: &Raw, what: &str, sets: bool) -> Option<NodePlace> {
        let text = raw.text().or_else(|| self.not(raw, what, "the name of a node"))?;
        if text == "ground" {
            return Some(NodePlace::default());
        }
        if let Some(of_mesh) = self.of_mesh(text) {
            return self.mesh_node(raw, what, sets, of_mesh);
        }
        let (name, edge, index) = self.node_parts(text);
        let Some(place) = self.find_where(name, |own| own.nodes.is_some()) else {
            if self.names_are_missing {
                return None;
            }
            let mut known = self.names_of(|own| own.nodes.is_some());
            known.push("ground".into());
            let text = match self.declared.iter().find(|own| own.name == name) {
                Some(other) => {
                    format!("\"{name}\" is a {}, which is no node; known: {}", other.section.name, known.join(", "))
                }
                None => unknown("node", name, &known),
            };
            return self.refuse(raw.at, format!("{what}: {text}"));
        };
        let Section { name: section, nodes: Some(nodes), .. } = self.declared[place].section else { return None };
        let found = edge.map(|edge| nodes.edges.iter().copied().find(|own| *own == edge));
        let right = match (found, index.len()) {
            (None, count) => count == nodes.own && (count > 0 || nodes.edges.is_empty()),
            (Some(None), _) => false,
            (Some(Some(_)), 0) => sets || nodes.of_edge == 0,
            (Some(Some(_)), count) => count == nodes.of_edge,
        };
        if !right {
            let ways = nodes.ways(name, sets).join(", ");
            return self
                .refuse(raw.at, format!("{what}: \"{text}\" is no node of the {section} \"{name}\"; there are: {ways}"));
        }
        Some(NodePlace { item: Some(place), edge: found.flatten(), index, points: Vec::new() })
    }

    /// The entry that a text names, the edge or end behind it, and the numbers behind these.
    fn node_parts<'t>(&self, text: &'t str) -> (&'t str, Option<&'t str>, Vec<usize>) {
        let is_known = |name: &str| self.find_where(name, |own| own.nodes.is_some()).is_some();
        if is_known(text) {
            return (text, None, Vec::new());
        }
        let (front, index) = divided(text);
        match front.rsplit_once('.') {
            Some((name, edge)) if !is_known(front) && is_known(name) => (name, Some(edge), index),
            _ => (front, None, index),
        }
    }
}

/// `plate[2, 3]` as `plate` and its numbers; what is no such thing stays as it is.
fn divided(text: &str) -> (&str, Vec<usize>) {
    let inside = text.strip_suffix(']').and_then(|front| front.rsplit_once('['));
    let numbers =
        inside.and_then(|(_, list)| list.split(',').map(|own| own.trim().parse().ok()).collect::<Option<Vec<_>>>());
    match (inside, numbers) {
        (Some((name, _)), Some(numbers)) => (name.trim_end(), numbers),
        _ => (text, Vec::new()),
    }
}

impl Reader {
    /// What others refer to comes before these, and otherwise the order of the file is kept.
    pub(super) fn order(&mut self, items: &[Item]) -> Vec<usize> {
        let needs: Vec<Vec<usize>> = items.iter().map(|item| item.fields.items()).collect();
        let mut by_file: Vec<usize> = (0..items.len()).collect();
        // entries of a loop stand at one place
        by_file.sort_by_key(|&place| items[place].fields.at);
        let (order, circle) = ordered(by_file, &needs);
        if let Some(circle) = circle {
            let names: Vec<&str> = circle.iter().map(|&place| &*items[place].name).collect();
            let at = items[circle[0]].fields.at;
            self.wrong(at, format!("\"{}\" needs itself to be there: {}", names[0], names.join(" -> ")));
        }
        order
    }
}
