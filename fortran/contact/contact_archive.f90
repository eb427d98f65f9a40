!> Contact laws in an archive (base_archive).
module contact_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_kinds, only: lk
   use contact_law, only: contact_law_t
   implicit none(type, external)
   private

   public :: visit_laws

contains

   subroutine visit_laws(archive, name, law)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(contact_law_t), allocatable, intent(inout), target :: law(:)
      integer(lk) :: n

      call archive%extent(name, law, n, "fcells ?")
      if (archive%is_loading) then
         if (allocated(law)) deallocate (law)
         if (n >= 0_lk) allocate (law(n))
      end if
      if (n > 0_lk) call archive%plain(name, c_loc(law), n*storage_size(law)/8_lk)
   end subroutine visit_laws

end module contact_archive
