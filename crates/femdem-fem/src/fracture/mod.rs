//! stub
use crate::{FemError, ElementStress};
use femdem_mesh::{Vector3, Matrix3};
use femdem_mesh::tet::{CrackedMesh, Split};
use serde::{Deserialize, Serialize};
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strength { tensile: f64, cohesion: f64, friction_angle: f64 }
impl Strength { pub fn new(tensile: f64, cohesion: f64, friction_angle: f64)->Result<Self,FemError>{Ok(Self{tensile,cohesion,friction_angle})} pub fn tensile(&self)->f64{self.tensile} pub fn cohesion(&self)->f64{self.cohesion} pub fn friction_angle(&self)->f64{self.friction_angle} }
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weibull { modulus: f64 }
impl Weibull { pub fn factor(&self, _b:u64,_n:u32,_v:f64)->f64{1.0} }
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FractureMode { Tension, Shear }
pub struct Cut { pub facet: u32, pub projection: f64, pub mode: FractureMode }
pub struct Decision { pub cuts: Vec<Cut>, pub splits: Vec<Split>, pub highest: f64 }
pub struct NodalDecision<'a> { pub strength: &'a Strength, pub factors: &'a [f64], pub positions: &'a [Vector3], pub stresses: &'a [ElementStress], pub volumes: &'a [f64] }
impl NodalDecision<'_> { pub fn decide(&self, m:&mut CrackedMesh)->Result<Decision,FemError>{
    let mut out=Decision{cuts:vec![],splits:vec![],highest:0.0};
    let mut x=self.positions.to_vec();
    let n0=m.points().len();
    let mut cand=vec![];
    for i in 0..n0 as u32 { let list=m.around(i); if list.len()<2 {continue}
        let mut s=Matrix3::zeros(); let mut vol=0.0;
        for &t in list { let v=self.volumes[t as usize]; s+=self.stresses[t as usize].cauchy*v; vol+=v; }
        s/=vol; let s=(s+s.transpose())*0.5;
        let e=s.symmetric_eigen(); let k=e.eigenvalues.imax(); let l=e.eigenvalues[k];
        let r=l/(self.strength.tensile*self.factors[m.points()[i as usize] as usize]);
        if r>out.highest {out.highest=r}
        if r>=1.0 { cand.push((r,i,e.eigenvectors.column(k).into_owned(),vol)); } }
    cand.sort_by(|a,b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut ring=vec![false;n0];
    for (r,i,d,vol) in cand {
        let list=m.around(i).to_vec(); if list.len()<2 {continue}
        let on=list.iter().any(|&t| m.facets().of_tets()[t as usize].iter().enumerate().any(|(k,f)| m.tets()[t as usize][k]!=i && f.is_some_and(|f| m.is_cut()[f as usize])));
        if ring[i as usize] && !on && r<1.15 {continue}
        let he=(6.0*vol/list.len() as f64).cbrt();
        let lab:Vec<f64>=list.iter().map(|&t|{ let c=m.tets()[t as usize].iter().map(|&k|x[k as usize]).sum::<Vector3>()*0.25-x[i as usize]; c.dot(&d)/he}).collect();
        let mut sg:Vec<f64>=lab.iter().map(|z| if *z>0.0{1.0}else{-1.0}).collect();
        for _ in 0..6 { let mut ch=false; for a in 0..list.len(){ if lab[a].abs()>=0.35{continue} let t=list[a] as usize; let mut s=0.15*lab[a]*he*he;
            for k in 0..4 { if m.tets()[t][k]==i {continue} let Some(f)=m.facets().of_tets()[t][k] else{continue}; if m.is_cut()[f as usize]{continue}
                let fa=m.facets().all()[f as usize]; let o=if fa.tets[0]==list[a]{fa.tets[1]}else{fa.tets[0]};
                let sd=m.sides(f).unwrap()[0].map(|q|x[q as usize]); let nn=(sd[1]-sd[0]).cross(&(sd[2]-sd[0])); let ar=0.5*nn.norm(); let nd=nn.normalize().dot(&d).abs();
                if let Ok(b)=list.binary_search(&o){ s+=ar*(1.0+1.5*(1.0-nd))*sg[b] } }
            let nv=if s>=0.0{1.0}else{-1.0}; if nv!=sg[a]{sg[a]=nv;ch=true} } if !ch{break} }
        if !sg.iter().any(|z|*z>0.0)||!sg.iter().any(|z|*z<0.0){continue}
        let mut cut=vec![];
        for a in 0..list.len(){ let t=list[a] as usize; for k in 0..4 { if m.tets()[t][k]==i{continue} let Some(f)=m.facets().of_tets()[t][k] else{continue}; if m.is_cut()[f as usize]{continue}
            let fa=m.facets().all()[f as usize]; let o=if fa.tets[0]==list[a]{fa.tets[1]}else{fa.tets[0]};
            if let Ok(b)=list.binary_search(&o){ if sg[a]!=sg[b] && !cut.contains(&f) { cut.push(f);
                let sd=m.sides(f).unwrap()[0].map(|q|x[q as usize]); let nn=(sd[1]-sd[0]).cross(&(sd[2]-sd[0])).normalize();
                out.cuts.push(Cut{facet:f,projection:nn.dot(&d).abs().max(0.05),mode:FractureMode::Tension}); } } } }
        for &t in &list { for q in m.tets()[t as usize] { if (q as usize)<n0 {ring[q as usize]=true} } }
        let sp=m.cut(&cut).unwrap();
        for s in &sp { let p=x[s.node as usize]; x.push(p); }
        out.splits.extend(sp);
    }
    Ok(out) } }
