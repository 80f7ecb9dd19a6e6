//! The sections of version 2: nodes and elements one by one, each element with its physical group.

use super::Reader;
use super::collected::Element;
use super::input::{Result, Wrong};
use super::kinds::{Kind, kind, refused};
use crate::scenes::mesh_data::FilePlace;
use std::collections::HashMap;

impl Reader<'_> {
    /// Nodes; with parameters on their entities, if the file was saved with them.
    pub(super) fn nodes(&mut self, have_parameters: bool) -> Result<()> {
        let count = self.input.size_on_line("the number of nodes")?;
        self.input.check_count(count, "nodes", [8, 28])?;
        for _ in 0..count {
            let place = self.input.place();
            let number = self.input.number("the number of a node")?;
            self.mesh.add_node(number, place)?;
            self.point(0)?;
            if have_parameters {
                let dimension = self.input.int("the dimension of an entity")?;
                self.input.int("the number of an entity")?;
                for _ in 0..if matches!(dimension, 1 | 2) { dimension } else { 0 } {
                    self.input.double("a parameter of a node")?;
                }
            }
        }
        Ok(())
    }

    /// Coordinates of a node, and the parameters behind them, which are passed over.
    pub(super) fn point(&mut self, parameters: usize) -> Result<()> {
        let mut at = [0.0; 3];
        for own in &mut at {
            *own = self.input.double("a coordinate of a node")?;
        }
        for _ in 0..parameters {
            self.input.double("a parameter of a node")?;
        }
        self.mesh.add_point(at);
        Ok(())
    }

    /// Numbers of the nodes of an element.
    pub(super) fn nodes_of_element(&mut self, kind: Kind) -> Result<Vec<usize>> {
        (0..kind.nodes).map(|_| self.input.number("the number of a node of an element")).collect()
    }

    /// Elements, in binary files in blocks of the same type and number of tags.
    pub(super) fn elements(&mut self) -> Result<()> {
        let count = self.input.size_on_line("the number of elements")?;
        self.input.check_count(count, "elements", [8, 8])?;
        let mut faces = HashMap::new();
        let mut there = 0;
        while there < count {
            let place = self.input.place();
            if self.input.binary {
                let kind = self.kind_at(place)?;
                let own = self.input.number("the number of elements of a block")?;
                let tags = self.input.number("the number of tags")?;
                self.input.check_count(own, "elements", [0, 4 + 4 * kind.nodes])?;
                if own > count - there {
                    let what = format!("a block has {own} elements where {} are left", count - there);
                    return Err(Wrong { place: Some(place), what });
                }
                for _ in 0..own {
                    let place = self.input.place();
                    let number = self.input.number("the number of an element")?;
                    self.element(kind, number, tags, place, &mut faces)?;
                }
                there += own;
            } else {
                let number = self.input.number("the number of an element")?;
                let kind = self.kind_at(place)?;
                let tags = self.input.number("the number of tags")?;
                self.element(kind, number, tags, place, &mut faces)?;
                there += 1;
            }
        }
        Ok(())
    }

    fn kind_at(&mut self, place: FilePlace) -> Result<Kind> {
        let number = self.input.int("the type of an element")?;
        kind(number).ok_or_else(|| Wrong { place: Some(place), what: refused(number) })
    }

    /// Tags and nodes of an element, which is written once for each of its physical groups.
    fn element(
        &mut self,
        kind: Kind,
        number: usize,
        tags: usize,
        place: FilePlace,
        faces: &mut HashMap<Vec<usize>, usize>,
    ) -> Result<()> {
        self.input.check_count(tags, "tags", [2, 4])?;
        let mut group = 0;
        for place in 0..tags {
            let tag = self.input.int("a tag of an element")?;
            group = if place == 0 { tag } else { group };
        }
        let nodes = self.nodes_of_element(kind)?;
        if let Some(&face) = faces.get(&nodes)
            && group != 0
            && self.mesh.add_to_group(face, group)
        {
            return Ok(());
        }
        let groups = if group == 0 { &[][..] } else { &[group] };
        let element = Element { kind, number, place, nodes: nodes.clone() };
        if let Some(face) = self.mesh.add_element(element, groups, false)? {
            faces.insert(nodes, face);
        }
        Ok(())
    }
}
