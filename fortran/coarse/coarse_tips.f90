!> Fracture cells at a tip, whose jumps the finite volumes do not resolve.
!!
!! Toward a tip the jump falls with the square root of the distance; it is linear in a fracture cell
!! here. A crack then slips and opens as if it were longer or shorter by a share of its tip cells
!! that does not fall with their size, and the error is of first order. That share depends on the
!! mode and on Poisson's ratio nu, hardly on the mesh: -0.19 + 0.42 nu for opening and 0.11 + 0.42
!! nu for slip, each within 0.03. A spring between the faces of the tip cells makes it vanish.
!!
!! The stiffness of the springs follows from the closed form of one crack in an infinite body under
!! uniform pressure, and under uniform shear without friction: means over cracks of 20 cells at 20,
!! 45 and 70 degrees, for nu from 0 to 0.48 (docs/theory.md; verification/tip_cells has other sizes,
!! angles and loads). At an opening tip it is negative, a quarter of what would make the body
!! unstable.
module coarse_tips
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_rock, only: rock_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: support_tips

contains

   !> Add the springs at the free tips to the condensed body.
   pure subroutine support_tips(mesh, rock, condensed)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(condensed_t), intent(inout) :: condensed
      real(rk) :: spring(2)
      integer(ik) :: at, component, end, k, tip

      spring = tip_springs(rock)
      do tip = 1, mesh%fracture%n_tips
         associate (cells => mesh%fracture%point_cells%of(mesh%fracture%tip_point(tip)))
            do k = 1, size(cells)
               do end = 1, 2
                  do component = 1, 2
                     at = condensed%layout%at_jump(cells(k), end) + component - 1
                     condensed%stiffness(at, at) = condensed%stiffness(at, at) + spring(component)
                  end do
               end do
            end do
         end associate
      end do
   end subroutine support_tips

   !> Stiffness at either end of a tip cell against opening and against slip [Pa].
   pure function tip_springs(rock) result(spring)
      type(rock_t), intent(in) :: rock
      real(rk) :: spring(2)  !< n, tau
      real(rk) :: crack_modulus, poisson

      associate (lame => rock%lame, shear => rock%shear)
         crack_modulus = 4.0_rk*shear*(lame + shear)/(lame + 2.0_rk*shear)
         poisson = lame/(2.0_rk*(lame + shear))
      end associate
      spring(1) = crack_modulus*(-0.0471_rk + poisson*(0.095_rk + 0.038_rk*poisson))
      spring(2) = crack_modulus*(0.0201_rk + poisson*(0.0627_rk + 0.0415_rk*poisson))
   end function tip_springs

end module coarse_tips
