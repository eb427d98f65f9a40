!> A body without a fluid in an archive (base_archive): its meshes are stored, its model is made
!! again from them.
submodule(mechanics_body) mechanics_body_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_kinds, only: lk
   use fine_archive, only: set_fine_extents, visit_contact, visit_fine_mesh, visit_loads
   use mesh_archive, only: visit_mesher, visit_mesher_and_mesh
   implicit none(type, external)

contains

   module procedure visit
      logical :: has_probes

      call archive%enter("body")
      call visit_mesher_and_mesh(archive, "mesh", self%mesher, self%mesh)
      if (archive%is_loading .and. .not. allocated(archive%fault)) then
         if (self%mesh%n_cells == 0) then
            call archive%set_fault("mesh")
         else
            call archive%compare_range("mesh", self%mesh%face_side, "; 0:sides")
         end if
         if (allocated(archive%fault)) return
         call self%set_up(scene, start, network, timers, error)
         if (allocated(error)) return
      end if
      call set_fine_extents(archive, self%model%mesh)
      call visit_loads(archive, "loads", self%loads)
      call archive%list("displacement", self%displacement, "2, fine_nodes ?")
      call visit_contact(archive, "contact", self%contact)
      call archive%list("given_jump", self%given_jump, "2, 3, fine_faces ?")
      call visit_intensities(archive, self%intensity)
      has_probes = allocated(self%probe)
      call archive%item("has_probes", has_probes)
      call archive%list("error", self%estimate%element)
      call archive%list("error_left_out", self%estimate%left_out)
      call archive%item("error_total", self%estimate%total)
      call archive%item("error_solution", self%estimate%solution)
      call archive%item("error_relative", self%estimate%relative)
      call archive%item("smallest_angle", self%smallest_angle)
      call visit_mesher(archive, "mesher_before", self%before%mesher)
      call visit_fine_mesh(archive, "fine_before", self%before%fine)
      call visit_contact(archive, "contact_before", self%before%contact)
      call archive%item("whole_meshes", self%whole_meshes)
      call archive%item("patched_meshes", self%patched_meshes)
      call archive%leave()
      if (allocated(archive%fault)) return
      if (archive%is_loading .and. has_probes) call self%find_probes(scene, error)
   end procedure visit

   subroutine visit_intensities(archive, intensity)
      type(archive_t), intent(inout) :: archive
      type(intensity_t), allocatable, intent(inout), target :: intensity(:)
      integer(lk) :: n

      call archive%extent("intensity", intensity, n)
      if (archive%is_loading) then
         if (allocated(intensity)) deallocate (intensity)
         if (n >= 0_lk) allocate (intensity(n))
      end if
      if (n > 0_lk) call archive%plain("intensity", c_loc(intensity), &
                                       n*storage_size(intensity)/8_lk)
   end subroutine visit_intensities

end submodule mechanics_body_archive
