!> How much fluid the rock of a scene stores, and what pressure a load makes in it at once.
module scene_storage
   use base_kinds, only: rk
   use scene_types, only: fluid_t, material_t
   implicit none(type, external)
   private

   public :: least_compressibility, skempton, solid_storage, storage

contains

   !> Storage S at fixed strain [1/Pa].
   pure real(rk) function storage(material, fluid)
      type(material_t), intent(in) :: material
      type(fluid_t), intent(in) :: fluid

      storage = material%porosity*fluid%compressibility + solid_storage(material)
   end function storage

   !> The part of the solid in it [1/Pa].
   pure real(rk) function solid_storage(material)
      type(material_t), intent(in) :: material

      solid_storage = (material%biot - material%porosity)/bulk_modulus(material)
      if (material%storage == "textbook") solid_storage = solid_storage*(1.0_rk - material%biot)
   end function solid_storage

   !> Skempton's coefficient B: pressure over mean compression where no fluid moves [-].
   pure real(rk) function skempton(material, fluid)
      type(material_t), intent(in) :: material
      type(fluid_t), intent(in) :: fluid

      skempton = 0.0_rk
      if (material%biot > 0.0_rk) then
         skempton = material%biot/(bulk_modulus(material)*storage(material, fluid) &
                                   + material%biot**2)
      end if
   end function skempton

   !> Compressibility of a fluid that makes Skempton's coefficient 1 [1/Pa]; only where pores would
   !! make it larger than that without one.
   pure real(rk) function least_compressibility(material)
      type(material_t), intent(in) :: material

      least_compressibility = (material%biot*(1.0_rk - material%biot)/bulk_modulus(material) &
                               - solid_storage(material))/material%porosity
   end function least_compressibility

   !> Drained [Pa].
   pure real(rk) function bulk_modulus(material)
      type(material_t), intent(in) :: material

      bulk_modulus = material%young/(3.0_rk*(1.0_rk - 2.0_rk*material%poisson))
   end function bulk_modulus

end module scene_storage
