!> The load programme: the load factors of the scene, with one part between each two of them, in
!! equal steps. A load that changes monotonically from one factor to another has a single part.
!!
!! The predicted load of the next onset of growth, from the intensities at two loads.
!!
!! Between changes of contact the intensities are linear in the load factor. Linear extrapolation
!! from two states then gives the exact onset; across such changes it gives an initial guess.
module mechanics_programme
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_tolerances, only: same_value
   use growth_law, only: growth_drive, growth_drive_t
   use scene_types, only: load_t
   implicit none(type, external)
   private

   public :: foreseen_onset, programme_t, reading_t, strongest

   !> Where the load stands in its programme.
   type :: programme_t
      real(rk), allocatable, private :: ends(:)  !< (0 to pieces) factors between them [-]
      integer(ik), private :: steps = 1  !< of each piece
      integer(ik), private :: piece = 1, step = 1  !< in which the load changes
   contains
      procedure :: begin
      procedure :: target
      procedure :: bounds
      procedure :: go_on
      procedure :: is_over
      procedure :: share_done
      procedure :: not_reached
   end type programme_t

   !> The free tips at a load.
   type :: reading_t
      real(rk) :: factor = 0.0_rk  !< of the load [-]
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
      self%piece = 1
      self%step = 1
   end subroutine begin

   !> The factor at the end of the present step [-].
   pure real(rk) function target(self)
      class(programme_t), intent(in) :: self

      target = step_end(self, self%step)
   end function target

   !> The factor at the end of a step of the present piece [-].
   pure real(rk) function step_end(self, step)
      class(programme_t), intent(in) :: self
      integer(ik), intent(in) :: step

      associate (from => self%ends(self%piece - 1), to => self%ends(self%piece))
         step_end = from + (to - from)*real(step, rk)/real(self%steps, rk)
         if (step >= self%steps) step_end = to
      end associate
   end function step_end

   !> Between which factors the load of a network in equilibrium is looked for: at most at the end
   !! of the present piece, and on its way there from the farthest factor that was before it [-].
   pure function bounds(self)
      class(programme_t), intent(in) :: self
      real(rk) :: bounds(2)

      associate (piece => min(self%piece, size(self%ends, kind=ik) - 1_ik))
         bounds(2) = self%ends(piece)
         bounds(1) = maxval(self%ends(0:piece - 1))
         if (self%ends(piece - 1) <= self%ends(piece)) bounds(1) = minval(self%ends(0:piece - 1))
      end associate
   end function bounds

   !> A state at a factor has nothing left to do there: on to the first step that ends beyond it.
   pure subroutine go_on(self, factor)
      class(programme_t), intent(inout) :: self
      real(rk), intent(in) :: factor  !< [-]
      integer(ik) :: step

      if (self%is_over()) return
      associate (way => self%ends(self%piece) - self%ends(self%piece - 1))
         do step = 1, merge(self%steps, 0_ik, abs(way) > 0.0_rk)
            self%step = step
            if ((step_end(self, step) - factor)/way > same_value) return
         end do
      end associate
      self%piece = self%piece + 1
      self%step = 1
   end subroutine go_on

   !> Nothing is left of the programme.
   pure logical function is_over(self)
      class(programme_t), intent(in) :: self

      is_over = self%piece >= size(self%ends, kind=ik)
   end function is_over

   !> What is told of the factors of a table that the load has not come to; else nothing.
   pure function not_reached(self) result(words)
      class(programme_t), intent(in) :: self
      character(len=:), allocatable :: words
      integer(ik) :: left

      words = ""
      left = size(self%ends, kind=ik) - self%piece
      if (size(self%ends) <= 2 .or. left < 1) return
      words = ", and "//integer_text(left)//" of the scene's load factors were not reached"
      if (left == 1) words = ", and the scene's last load factor was not reached"
   end function not_reached

   !> The share of the pieces that a state at a factor has behind it [-].
   pure real(rk) function share_done(self, factor) result(share)
      class(programme_t), intent(in) :: self
      real(rk), intent(in) :: factor  !< [-]

      associate (pieces => size(self%ends) - 1)
         share = real(min(int(self%piece) - 1, pieces), rk)/real(pieces, rk)
         if (self%is_over()) return
         associate (from => self%ends(self%piece - 1), to => self%ends(self%piece))
            if (.not. abs(to - from) > 0.0_rk) return
            share = share + (factor - from)/(to - from)/real(pieces, rk)
         end associate
      end associate
   end function share_done

   !> The factor of a programme that is the largest, whatever its sign; at least one given [-].
   pure real(rk) function strongest(load, factor)
      type(load_t), intent(in) :: load
      real(rk), intent(in) :: factor  !< [-]

      strongest = factor
      if (.not. allocated(load%factors)) return
      if (maxval(abs(load%factors)) > abs(factor)) then
         strongest = load%factors(maxloc(abs(load%factors), dim=1))
      end if
   end function strongest

   !> The factor between two limits at which the largest equivalent intensity, were the intensities
   !! linear in the factor, reaches the toughness. Where they would not do so in between, it is the
   !! middle.
   pure real(rk) function foreseen_onset(a, b, low, high, toughness) result(factor)
      type(reading_t), intent(in) :: a, b  !< at different factors
      real(rk), intent(in) :: low, high  !< limits, in this order on the way of the load [-]
      real(rk), intent(in) :: toughness  !< [Pa sqrt(m)]
      integer, parameter :: halvings = 200  ! more than there are digits: it ends by itself
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

      !> Of the intensities on the lines over the toughness [Pa sqrt(m)].
      pure real(rk) function excess(at)
         real(rk), intent(in) :: at  !< factor [-]
         type(growth_drive_t) :: drive(size(a%k1))
         real(rk) :: share

         share = (at - a%factor)/(b%factor - a%factor)
         drive = growth_drive(a%k1 + share*(b%k1 - a%k1), a%k2 + share*(b%k2 - a%k2), 1.0_rk)
         excess = maxval(drive%intensity) - toughness
      end function excess

   end function foreseen_onset

end module mechanics_programme
