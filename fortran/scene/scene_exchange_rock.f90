!> Carries the rock, that of the whole body and that of regions, between the groups of a sheet and a
!! scene, either way.
module scene_exchange_rock
   use base_kinds, only: rk
   use scene_exchange_values, only: exchange
   use scene_sheet, only: record_t
   use scene_types, only: material_t, name_length, region_t
   implicit none(type, external)
   private

   public :: exchange_material, exchange_region, not_given

   !> What stands for a number of a region's rock that the region does not give: no rock has it.
   real(rk), parameter :: not_given = huge(1.0_rk)

contains

   pure subroutine exchange_material(record, material, reading)
      type(record_t), intent(inout) :: record
      type(material_t), intent(inout) :: material
      logical, intent(in) :: reading
      character(len=name_length) :: plane

      call exchange(record, "young", material%young, reading)
      call exchange(record, "poisson", material%poisson, reading)
      call exchange(record, "biot", material%biot, reading)
      call exchange(record, "porosity", material%porosity, reading)
      call exchange_permeability(record, material, reading)
      call exchange(record, "density", material%density, reading, nothing=0.0_rk)
      call exchange(record, "toughness", material%toughness, reading, nothing=huge(1.0_rk))
      call exchange(record, "radiation_damping", material%radiation_damping, reading)
      plane = merge("stress", "strain", material%plane_stress)
      call exchange(record, "plane", plane, reading)
      material%plane_stress = plane == "stress"
      call exchange(record, "storage", material%storage, reading)
   end subroutine exchange_material

   !> What the region does not give itself is left to scene_defaults.
   pure subroutine exchange_region(record, region, reading)
      type(record_t), intent(inout) :: record
      type(region_t), intent(inout) :: region
      logical, intent(in) :: reading

      call exchange(record, "name", region%name, reading)
      call exchange(record, "shape", region%shape, reading)
      if (region%shape == "parabola") then
         call exchange(record, "x_vertex", region%x_vertex, reading)
         call exchange(record, "y_vertex", region%y_vertex, reading)
         call exchange(record, "curvature", region%curvature, reading)
      else
         call exchange(record, "x", region%x, reading)
         call exchange(record, "y", region%y, reading)
      end if
      if (region%shape == "band") then
         call exchange(record, "x_other", region%x_other, reading)
         call exchange(record, "y_other", region%y_other, reading)
      end if
      associate (own => region%material)
         if (reading) then
            own%young = not_given
            own%poisson = not_given
            own%biot = not_given
            own%porosity = not_given
            own%density = not_given
            own%toughness = not_given
         end if
         call exchange(record, "young", own%young, reading)
         call exchange(record, "poisson", own%poisson, reading)
         call exchange(record, "biot", own%biot, reading)
         call exchange(record, "porosity", own%porosity, reading)
         call exchange_permeability(record, own, reading)
         call exchange(record, "density", own%density, reading, nothing=0.0_rk)
         call exchange(record, "toughness", own%toughness, reading, nothing=huge(1.0_rk))
      end associate
   end subroutine exchange_region

   !> Isotropic, or the components of a tensor.
   pure subroutine exchange_permeability(record, material, reading)
      type(record_t), intent(inout) :: record
      type(material_t), intent(inout) :: material
      logical, intent(in) :: reading

      if (reading .and. record%is_set("permeability")) then
         call exchange(record, "permeability", material%permeability_xx, reading)
         material%permeability_yy = material%permeability_xx
      end if
      call exchange(record, "permeability_xx", material%permeability_xx, reading, nothing=0.0_rk)
      call exchange(record, "permeability_yy", material%permeability_yy, reading, nothing=0.0_rk)
      call exchange(record, "permeability_xy", material%permeability_xy, reading, nothing=0.0_rk)
   end subroutine exchange_permeability

end module scene_exchange_rock
