//! The sections of versions 4.0 and 4.1: nodes and elements in blocks, each of an entity, which knows its physical groups.

use super::Reader;
use super::collected::{ENTITIES, Element};
use super::input::{Result, Wrong};
use super::kinds::{Kind, kind, refused};
use crate::scenes::mesh_data::FilePlace;
use std::collections::HashMap;

/// Physical groups of an entity; a minus sign turns its elements round.
type Groups = Vec<i32>;

/// By dimension and number.
pub(super) type Entities = HashMap<(i32, i32), Groups>;

impl Reader<'_> {
    pub(super) fn entities(&mut self) -> Result<()> {
        let mut entities = HashMap::new();
        let mut counts = [0; 4];
        for (count, words) in counts.iter_mut().zip(["points", "curves", "surfaces", "volumes"]) {
            *count = self.input.size(&format!("the number of {words}"))?;
            self.input.check_count(*count, words, [10, 36])?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let number = self.input.int("the number of an entity")?;
                // a box, which version 4.1 narrows to a point
                for _ in 0..if dimension == 0 && self.version > 4.0 { 3 } else { 6 } {
                    self.input.double("a coordinate of an entity")?;
                }
                let of_groups = self.input.size("the number of physical groups")?;
                self.input.check_count(of_groups, "physical groups", [2, 4])?;
                let groups = (0..of_groups).map(|_| self.input.int("the number of a physical group"));
                let groups = groups.collect::<Result<_>>()?;
                if dimension > 0 {
                    let parts = self.input.size("the number of bounding entities")?;
                    self.input.check_count(parts, "bounding entities", [2, 4])?;
                    for _ in 0..parts {
                        self.input.int("the number of a bounding entity")?;
                    }
                }
                if entities.insert((dimension, number), groups).is_some() {
                    return self.input.wrong(format!("{} {number} is there twice", ENTITIES[dimension as usize]));
                }
            }
        }
        self.entities = Some(entities);
        Ok(())
    }

    /// The least and largest numbers that version 4.1 announces.
    fn announced(&mut self, what: &str) -> Result<std::ops::RangeInclusive<usize>> {
        if self.version < 4.1 {
            return Ok(0..=usize::MAX);
        }
        let least = self.input.size(&format!("the least number of {what}"))?;
        Ok(least..=self.input.size(&format!("the largest number of {what}"))?)
    }

    fn announced_number(&mut self, what: &str, announced: &std::ops::RangeInclusive<usize>) -> Result<usize> {
        let place = Some(self.input.place());
        let number = self.input.number(&format!("the number of {what}"))?;
        if announced.contains(&number) {
            return Ok(number);
        }
        let (least, most) = (announced.start(), announced.end());
        let what = format!("the number of {what} is {number}; the section announces numbers from {least} to {most}");
        Err(Wrong { place, what })
    }

    pub(super) fn nodes_in_blocks(&mut self) -> Result<()> {
        let blocks = self.input.size("the number of blocks of nodes")?;
        let count = self.input.size("the number of nodes")?;
        let announced = self.announced("a node")?;
        self.input.check_count(blocks, "blocks of nodes", [8, 20])?;
        self.input.check_count(count, "nodes", [8, 28])?;
        let mut there = 0;
        for _ in 0..blocks {
            let (dimension, _) = self.entity()?;
            let parametric = self.input.int("whether nodes have parameters")?;
            if !matches!(parametric, 0 | 1) {
                return self.input.wrong(format!("whether nodes have parameters must be 0 or 1; it is {parametric}"));
            }
            let own = self.input.size("the number of nodes of a block")?;
            self.input.check_count(own, "nodes", [8, 28])?;
            let parameters = (dimension * parametric) as usize;
            // version 4.1 has all numbers of a block before all coordinates
            let is_apart = self.version > 4.0;
            for _ in 0..if is_apart { own } else { 0 } {
                self.node_number(&announced)?;
            }
            for _ in 0..own {
                if !is_apart {
                    self.node_number(&announced)?;
                }
                self.point(parameters)?;
            }
            there += own;
        }
        if there != count {
            return self.input.wrong(format!("the section announces {count} nodes, and its blocks have {there}"));
        }
        Ok(())
    }

    fn node_number(&mut self, announced: &std::ops::RangeInclusive<usize>) -> Result<()> {
        let place = self.input.place();
        let number = self.announced_number("a node", announced)?;
        self.mesh.add_node(number, place)
    }

    pub(super) fn elements_in_blocks(&mut self) -> Result<()> {
        let blocks = self.input.size("the number of blocks of elements")?;
        let count = self.input.size("the number of elements")?;
        let announced = self.announced("an element")?;
        self.input.check_count(blocks, "blocks of elements", [8, 20])?;
        self.input.check_count(count, "elements", [4, 8])?;
        let mut there = 0;
        for _ in 0..blocks {
            let block = self.input.place();
            let entity = self.entity()?;
            let number = self.input.int("the type of elements")?;
            let own = self.input.size("the number of elements of a block")?;
            let kind = self.kind(number, entity, block)?;
            self.input.check_count(own, "elements", [2 + 2 * kind.nodes, 4 + 4 * kind.nodes])?;
            let groups = self.groups_of(entity, block)?;
            let is_turned = self.is_turned(&groups, entity, block)?;
            for _ in 0..own {
                let place = self.input.place();
                let number = self.announced_number("an element", &announced)?;
                let nodes = self.nodes_of_element(kind)?;
                self.mesh.add_element(Element { kind, number, place, nodes }, &groups, is_turned)?;
            }
            there += own;
        }
        if there != count {
            return self.input.wrong(format!("the section announces {count} elements, and its blocks have {there}"));
        }
        Ok(())
    }

    /// Dimension and number of an entity, which stand the other way round in version 4.0.
    fn entity(&mut self) -> Result<(i32, i32)> {
        let is_turned = self.version < 4.1;
        let early = if is_turned { self.input.int("the number of an entity")? } else { 0 };
        let dimension = self.input.int("the dimension of an entity")?;
        if !(0..=3).contains(&dimension) {
            return self.input.wrong(format!("the dimension of an entity must be from 0 to 3; it is {dimension}"));
        }
        Ok((dimension, if is_turned { early } else { self.input.int("the number of an entity")? }))
    }

    /// What an entity is called in messages: by its physical groups, or by its number.
    fn called(&self, entity: (i32, i32)) -> String {
        let (dimension, number) = entity;
        let groups = self.entities.as_ref().and_then(|all| all.get(&entity)).cloned().unwrap_or_default();
        let names: Vec<String> = groups.iter().map(|group| self.mesh.name((dimension, group.unsigned_abs()))).collect();
        let own = format!("{} {number}", ENTITIES[dimension as usize]);
        if names.is_empty() { own } else { format!("{own}, of the physical group \"{}\"", names.join("\", \"")) }
    }

    fn kind(&self, number: i32, entity: (i32, i32), block: FilePlace) -> Result<Kind> {
        let what = match kind(number) {
            Some(kind) if kind.dimension == entity.0 => return Ok(kind),
            Some(kind) => format!("{} cannot be a part of it", kind.words()),
            None => refused(number),
        };
        Err(Wrong { place: Some(block), what: format!("{}: {what}", self.called(entity)) })
    }

    fn groups_of(&self, entity: (i32, i32), block: FilePlace) -> Result<Groups> {
        let Some(entities) = &self.entities else { return Ok(Vec::new()) };
        entities.get(&entity).cloned().ok_or_else(|| {
            let what = format!("there is no {} in $Entities", self.called(entity));
            Wrong { place: Some(block), what }
        })
    }

    fn is_turned(&self, groups: &Groups, entity: (i32, i32), block: FilePlace) -> Result<bool> {
        let turned = groups.iter().filter(|group| **group < 0).count();
        if turned > 0 && turned < groups.len() && entity.0 == 2 {
            let called = self.called(entity);
            let what = format!(
                "{called} is in one with a minus sign and in another without, so that its normal has two directions"
            );
            return Err(Wrong { place: Some(block), what });
        }
        Ok(turned > 0)
    }
}
