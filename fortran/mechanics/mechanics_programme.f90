!> The load programme: the load factors of the scene, with one part between each two of them, in
!! equal steps. A load that changes monotonically from one factor to another has a single part.
!!
!! The predicted load of the next onset of growth: between changes of contact the intensities are
!! linear in the load factor, so that linear extrapolation from two states gives the exact onset.
!! Across such changes it gives an initial guess.
module mechanics_programme
   use base_archive, only: archive_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_tolerances, only: same_value
   use growth_law, only: growth_drive, growth_drive_t
   use scene_types, only: load_t
   implicit none(type, external)
   private

   public :: predicted_onset, programme_t, reading_t, strongest

   !> Position in the load programme.
   type :: programme_t
      real(rk), allocatable, private :: ends(:)  !< (0 to parts) load factors at their ends [-]
      integer(ik), private :: steps = 1  !< steps of each part
      integer(ik), private :: part = 1, step = 1  !< present part and step
   contains
      procedure :: begin
      procedure :: target
      procedure :: bounds
      procedure :: advance
      procedure :: is_over
      procedure :: share_done
      procedure :: not_reached
      procedure :: visit
   end type programme_t

   !> Intensities of the free tips at a load.
   type :: reading_t
      real(rk) :: factor = 0.0_rk  !< load factor [-]
      real(rk), allocatable :: k1(:), k2(:)  !< (tips) [Pa sqrt(m)]
   end type reading_t

contains

   !> Begin the programme of a scene, at its first factor.
   pure subroutine begin(self, load)
      class(programme_t), intent(inout) :: self
      type(load_t), intent(in) :: load

      if (allocated(self%ends)) deallocate (self%ends)
      if (allocated(load%factors)) then
         allocate (self%ends(0:size(load%factors)))
         self%ends(1:) = load%factors
      else
         allocate (self%ends(0:1))
         self%ends(1) = load%to
      end if
      self%ends(0) = load%from
      self%steps = load%steps
      self%part = 1
      self%step = 1
   end subroutine begin

   !> The factor at the end of the present step [-].
   pure real(rk) function target(self)
      class(programme_t), intent(in) :: self

      target = step_end(self, self%step)
   end function target

   !> The factor at the end of a step of the present part [-].
   pure real(rk) function step_end(self, step)
      class(programme_t), intent(in) :: self
      integer(ik), intent(in) :: step

      associate (from => self%ends(self%part - 1), to => self%ends(self%part))
         step_end = from + (to - from)*real(step, rk)/real(self%steps, rk)
         if (step >= self%steps) step_end = to
      end associate
   end function step_end

   !> Load factors between which the equilibrium load of a network is searched: the second is that
   !! at the end of the present part, the first the farthest one before it [-].
   pure function bounds(self)
      class(programme_t), intent(in) :: self
      real(rk) :: bounds(2)

      associate (part => min(self%part, size(self%ends, kind=ik) - 1_ik))
         bounds(2) = self%ends(part)
         bounds(1) = maxval(self%ends(0:part - 1))
         if (self%ends(part - 1) <= self%ends(part)) bounds(1) = minval(self%ends(0:part - 1))
      end associate
   end function bounds

   !> Continue with the first step that ends beyond a factor.
   pure subroutine advance(self, factor)
      class(programme_t), intent(inout) :: self
      real(rk), intent(in) :: factor  !< [-]
      integer(ik) :: step

      if (self%is_over()) return
      associate (change => self%ends(self%part) - self%ends(self%part - 1))
         do step = 1, merge(self%steps, 0_ik, abs(change) > 0.0_rk)
            self%step = step
            if ((step_end(self, step) - factor)/change > same_value) return
         end do
      end associate
      self%part = self%part + 1
      self%step = 1
   end subroutine advance

   !> The programme has been completed.
   pure logical function is_over(self)
      class(programme_t), intent(in) :: self

      is_over = self%part >= size(self%ends, kind=ik)
   end function is_over

   !> End of a sentence about the factors of a table that the load has not reached; empty if it has
   !! reached all.
   pure function not_reached(self) result(words)
      class(programme_t), intent(in) :: self
      character(len=:), allocatable :: words
      integer(ik) :: left

      words = ""
      left = size(self%ends, kind=ik) - self%part
      if (size(self%ends) <= 2 .or. left < 1) return
      words = ", and "//integer_text(left)//" of the scene's load factors were not reached"
      if (left == 1) words = ", and the scene's last load factor was not reached"
   end function not_reached

   !> Completed fraction of the programme in a state at a factor [-].
   pure real(rk) function share_done(self, factor) result(share)
      class(programme_t), intent(in) :: self
      real(rk), intent(in) :: factor  !< [-]

      associate (parts => size(self%ends) - 1)
         share = real(min(int(self%part) - 1, parts), rk)/real(parts, rk)
         if (self%is_over()) return
         associate (from => self%ends(self%part - 1), to => self%ends(self%part))
            if (.not. abs(to - from) > 0.0_rk) return
            share = share + (factor - from)/(to - from)/real(parts, rk)
         end associate
      end associate
   end function share_done

   !> The factor of a programme, or the given one, with the largest absolute value [-].
   pure real(rk) function strongest(load, factor)
      type(load_t), intent(in) :: load
      real(rk), intent(in) :: factor  !< [-]

      strongest = factor
      if (.not. allocated(load%factors)) return
      if (maxval(abs(load%factors)) > abs(factor)) then
         strongest = load%factors(maxloc(abs(load%factors), dim=1))
      end if
   end function strongest

   !> Predicted onset: the factor between two limits at which the largest K_eq, with intensities
   !! linear in the factor, is K_IC. Without such a factor the middle between the limits [-].
   pure real(rk) function predicted_onset(a, b, low, high, toughness) result(factor)
      type(reading_t), intent(in) :: a, b  !< at different factors
      real(rk), intent(in) :: low, high  !< limits; K_eq < K_IC at low [-]
      real(rk), intent(in) :: toughness  !< [Pa sqrt(m)]
      integer, parameter :: halvings = 200  ! more than there are binary digits
      real(rk) :: below, above
      integer :: k

      factor = 0.5_rk*(low + high)
      if (excess(low) >= 0.0_rk .or. excess(high) <= 0.0_rk) return
      below = low
      above = high
      do k = 1, halvings
         factor = 0.5_rk*(below + above)
         if (.not. (factor > min(below, above) .and. factor < max(below, above))) exit
         if (excess(factor) < 0.0_rk) then
            below = factor
         else
            above = factor
         end if
      end do

   contains

      !> Largest K_eq less K_IC, with linear intensities [Pa sqrt(m)].
      pure real(rk) function excess(at)
         real(rk), intent(in) :: at  !< load factor [-]
         type(growth_drive_t) :: drive(size(a%k1))
         real(rk) :: share

         share = (at - a%factor)/(b%factor - a%factor)
         drive = growth_drive(a%k1 + share*(b%k1 - a%k1), a%k2 + share*(b%k2 - a%k2), 1.0_rk)
         excess = maxval(drive%intensity) - toughness
      end function excess

   end function predicted_onset

   !> Store or load the position; the programme itself is that of the scene.
   subroutine visit(self, archive)
      class(programme_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%item("part", self%part)
      call archive%item("step", self%step)
   end subroutine visit

end module mechanics_programme
